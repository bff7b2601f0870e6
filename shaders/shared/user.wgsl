/// The host's 32 bits between three vertices with weights `w`: their bytes are interpolated one by one, unless all are
/// the same.
fn daa_user_between(user: vec3u, w: vec3f) -> u32 {
    if user.x == user.y && user.x == user.z {
        return user.x;
    }
    return pack4x8unorm(unpack4x8unorm(user.x) * w.x + unpack4x8unorm(user.y) * w.y + unpack4x8unorm(user.z) * w.z);
}
