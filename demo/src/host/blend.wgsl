// Draws blended surfaces over the image. Joined with fragment.wgsl and what that takes.

@fragment
fn blend_fragment(v: Varying, @builtin(front_facing) winds: bool) -> @location(0) vec4f {
    // A matrix that mirrors turns the winding round.
    let c = shaded(v, winds == (instances[v.instance].handedness > 0.0));
    return vec4f(c.rgb * c.a, c.a);
}
