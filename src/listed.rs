//! listed: `shade` for the executions that work on a list.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::{self, List, ListKind, Scratch, WORK_BYTES};

pub(crate) const INFO: PassInfo = PassInfo {
    name: "shade",
    reads: &[Resource::GBuffer, Resource::Host, Resource::First, Resource::Plan, Resource::List],
    writes: &[Resource::Color, Resource::Statistics],
};

/// Where something was traced.
pub(crate) const INFO_TRACED: PassInfo = PassInfo {
    reads: &[Resource::GBuffer, Resource::Host, Resource::First, Resource::Plan, Resource::List, Resource::Traced],
    ..INFO
};

/// The ways to run it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Listing {
    Bucketed,
    Sorted,
    Packed,
}

impl Listing {
    pub fn kind(self) -> ListKind {
        match self {
            Self::Bucketed | Self::Sorted => ListKind::Pixels,
            Self::Packed => ListKind::Samples,
        }
    }

    /// What `shade` reads and writes.
    pub fn info(self, traced: bool) -> PassInfo {
        let info = if traced { INFO_TRACED } else { INFO };
        match self {
            Self::Bucketed | Self::Sorted => info,
            // The colours of a batch lie beside the list.
            Self::Packed => PassInfo { writes: &[Resource::Color, Resource::List, Resource::Statistics], ..info },
        }
    }
}

/// Group 3 of each pipeline.
#[derive(Debug)]
pub(crate) struct Bound {
    shade: wgpu::BindGroup,
    gather: Option<wgpu::BindGroup>,
}

#[derive(Debug)]
pub(crate) struct Listed {
    pixel_layout: wgpu::BindGroupLayout,
    sample_layout: wgpu::BindGroupLayout,
    gather_layout: wgpu::BindGroupLayout,
    pixels: [Lazy<wgpu::ComputePipeline>; Traced::COUNT],
    samples: [Lazy<wgpu::ComputePipeline>; Traced::COUNT],
    gather: [Lazy<wgpu::ComputePipeline>; Traced::COUNT],
}

impl Listed {
    pub fn new(device: &wgpu::Device) -> Self {
        let compute = wgpu::ShaderStages::COMPUTE;
        let layout = |entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("daa listed"), entries })
        };
        let [first, plan, color] = [entry::texture(0, compute), entry::buffer(1, compute, true), entry::store(2)];
        let statistics = entry::buffer(3, compute, false);
        let [list, work] = [entry::buffer(4, compute, true), entry::part(5, compute, WORK_BYTES)];
        let colors = entry::buffer(6, compute, false);
        Self {
            pixel_layout: layout(&[first, plan, color, statistics, list, work]),
            sample_layout: layout(&[plan, statistics, list, work, colors]),
            gather_layout: layout(&[first, plan, color, work, colors, entry::buffer(7, compute, true)]),
            pixels: Default::default(),
            samples: Default::default(),
            gather: Default::default(),
        }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch, list: &List) -> Bound {
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let first = entry(0, wgpu::BindingResource::TextureView(&scratch.first));
        let plan = entry(1, scratch.plan.as_entire_binding());
        let color = entry(2, wgpu::BindingResource::TextureView(&scratch.color));
        let statistics = entry(3, scratch.statistics.as_entire_binding());
        let entries = entry(4, list.list.as_entire_binding());
        let work = wgpu::BufferBinding { buffer: &list.work, offset: 0, size: wgpu::BufferSize::new(WORK_BYTES) };
        let work = entry(5, wgpu::BindingResource::Buffer(work));
        let group = |layout, entries: &[wgpu::BindGroupEntry<'_>]| {
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("daa listed"), layout, entries })
        };
        let Some(colors) = &list.colors else {
            let entries = [first, plan, color, statistics, entries, work];
            return Bound { shade: group(&self.pixel_layout, &entries), gather: None };
        };
        let colors = entry(6, colors.as_entire_binding());
        let rows = entry(7, list.rows.as_entire_binding());
        let shade = group(&self.sample_layout, &[plan.clone(), statistics, entries, work.clone(), colors.clone()]);
        Bound { shade, gather: Some(group(&self.gather_layout, &[first, plan, color, work, colors, rows])) }
    }

    /// Compiles what this listing needs.
    pub fn warm_up(&self, build: &Build, listing: Listing, traced: Traced) -> Result<(), PipelineError> {
        self.pipeline(build, listing.kind(), traced)?;
        if listing == Listing::Packed { self.gather(build, traced).map(|_| ()) } else { Ok(()) }
    }

    fn pipeline(&self, build: &Build, kind: ListKind, traced: Traced) -> Result<&wgpu::ComputePipeline, PipelineError> {
        let (lazy, entry, layout) = match kind {
            ListKind::Pixels => (&self.pixels, "daa_shade_pixels", &self.pixel_layout),
            ListKind::Samples => (&self.samples, "daa_shade_packed", &self.sample_layout),
        };
        let source = || source(build, traced);
        lazy[traced.index()].get(|| build.compute(INFO.name, source(), entry, layout, Some(traced)))
    }

    fn gather(&self, build: &Build, traced: Traced) -> Result<&wgpu::ComputePipeline, PipelineError> {
        let source = || source(build, traced);
        let layout = &self.gather_layout;
        self.gather[traced.index()].get(|| build.compute(INFO.name, source(), "daa_shade_gather", layout, Some(traced)))
    }

    /// Groups 0 to 2 are set.
    pub fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        build: &Build,
        (listing, traced): (Listing, Traced),
        list: &List,
        bound: &Bound,
        size: [u32; 2],
    ) {
        let Ok(pipeline) = self.pipeline(build, listing.kind(), traced) else { return };
        let tiles = scratch::tiles(size);
        // Work 0 is the whole list of pixels, the others a row or a batch each.
        let parts = match listing {
            Listing::Sorted => 0..=0,
            Listing::Bucketed => 1..=ListKind::Pixels.rows(build.m),
            Listing::Packed => 1..=scratch::batches(size, build.m),
        };
        for part in parts {
            let offset = part * WORK_BYTES as u32;
            pass.set_pipeline(pipeline);
            pass.set_bind_group(3, &bound.shade, &[offset]);
            pass.dispatch_workgroups_indirect(&list.work, u64::from(offset) + List::GROUPS_AT);
            if let (Some(group), Ok(gather)) = (&bound.gather, self.gather(build, traced)) {
                pass.set_pipeline(gather);
                pass.set_bind_group(3, group, &[offset]);
                pass.dispatch_workgroups(tiles[0], tiles[1], 1);
            }
        }
    }
}

fn source(build: &Build, traced: Traced) -> String {
    let pass = concat!(
        include_str!("../shaders/work.wgsl"),
        "\n",
        include_str!("../shaders/shade.wgsl"),
        "\n",
        include_str!("../shaders/listed.wgsl")
    );
    build.host.join(pass, traced)
}
