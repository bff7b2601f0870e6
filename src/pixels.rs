//! Group 3 of the passes that put pixels together: S, the plan, the image and the counters, in this order.

use crate::pipeline::entry;
use crate::scratch::Scratch;

/// `plans`: the pass writes the plan, too.
pub(crate) fn layout(device: &wgpu::Device, label: &str, plans: bool) -> wgpu::BindGroupLayout {
    let compute = wgpu::ShaderStages::COMPUTE;
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &[
            entry::texture(0, compute),
            entry::buffer(1, compute, !plans),
            entry::store(2),
            entry::buffer(3, compute, false),
        ],
    })
}

pub(crate) fn bind(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    scratch: &Scratch,
) -> wgpu::BindGroup {
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&scratch.first) },
            wgpu::BindGroupEntry { binding: 1, resource: scratch.plan.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&scratch.color) },
            wgpu::BindGroupEntry { binding: 3, resource: scratch.statistics.as_entire_binding() },
        ],
    })
}
