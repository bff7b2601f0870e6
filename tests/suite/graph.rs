//! A small frame graph as a host might have one: it reorders passes, leaves out those that nobody needs, and gives the
//! memory of resources that are not alive to others and to passes of its own. The image is that of `record`, bit for
//! bit.

use crate::shadows::{host, host_on, tiers};
use deferred_aa::rays::RayTier;
use deferred_aa::{
    DebugView, DeferredAa, Effect, Execution, Frame, Goal, LendError, Lent, Lifetime, Part, PartInfo, PartKind, Pass,
    Physical, RecordError, Resource, ResourceSet, Settings, Technique, wgpu,
};
use deferred_aa_demo::host::Host;
use deferred_aa_demo::scene::builtin::builtin;

const SIZE: [u32; 2] = [48, 29];

/// Every technique, and every execution.
fn ways() -> Vec<Settings> {
    let techniques = [Technique::Full, Technique::Single, Technique::Reconstructed, Technique::Selective];
    let techniques = techniques.map(|technique| Settings { technique, ..Default::default() });
    let executions = Execution::ALL.map(|execution| Settings { execution, ..Default::default() });
    let mut lattices = [Settings { technique: Technique::MultiResolution, ..Default::default() }; 2];
    lattices[0].multi_resolution.supersampled = true;
    lattices[1].multi_resolution.supersampled = false;
    [&techniques[..], &executions, &lattices].concat()
}

/// Which of the passes that are ready comes next.
#[derive(Debug, Clone, Copy)]
enum Pick {
    Last,
    Seeded(u32),
}

/// What a graph may get wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Flaw {
    None,
    /// It orders nothing.
    Disorder,
    /// It takes memory back before the last pass that reads it.
    ShortLives,
    /// It forgets what `begin` clears.
    LateLives,
}

/// A frame as the graph runs it.
struct Graph {
    passes: Vec<Pass>,
    /// Of `DeferredAa::passes`.
    left_out: usize,
    reordered: bool,
    flaw: Flaw,
}

/// Where a resource is alive: indices of passes, and −1 for before the first.
type Span = [i32; 2];

fn meet(a: ResourceSet, b: ResourceSet) -> bool {
    a.iter().any(|r| !r.is_unordered() && b.contains(r))
}

/// Whether a pass has to stay behind one that comes before it.
fn depends(later: &Pass, earlier: &Pass) -> bool {
    let (later, earlier) = (later.info, earlier.info);
    meet(earlier.writes, later.reads) || meet(earlier.reads, later.writes) || meet(earlier.writes, later.writes)
}

impl Graph {
    fn new(all: Vec<Pass>, wanted: &[Resource], pick: Pick, flaw: Flaw) -> Self {
        let mut live = wanted.to_vec();
        let mut waiting = Vec::new();
        for pass in all.iter().rev() {
            if pass.info.writes.iter().any(|r| live.contains(&r)) {
                live.extend(pass.info.reads.iter());
                waiting.insert(0, *pass);
            }
        }
        let in_order = waiting.clone();
        let mut passes = Vec::new();
        while !waiting.is_empty() {
            let is_ready = |&i: &usize| {
                flaw == Flaw::Disorder || !waiting[..i].iter().any(|earlier| depends(&waiting[i], earlier))
            };
            let ready: Vec<usize> = (0..waiting.len()).filter(is_ready).collect();
            let chosen = match pick {
                Pick::Last => ready.len() - 1,
                Pick::Seeded(seed) => (crate::harness::noise(seed + passes.len() as u32) * ready.len() as f32) as usize,
            };
            passes.push(waiting.remove(ready[chosen]));
        }
        Self { left_out: all.len() - passes.len(), reordered: passes != in_order, passes, flaw }
    }

    fn span(&self, part: &PartInfo) -> Span {
        let uses = |pass: &Pass| pass.info.reads.iter().chain(pass.info.writes.iter()).any(|r| r == part.resource);
        let first = self.passes.iter().position(uses).map_or(0, |i| i as i32);
        let last = self.passes.iter().rposition(uses).map_or(-1, |i| i as i32);
        let cleared = part.lifetime == (Lifetime::Transient { from_begin: true }) && self.flaw != Flaw::LateLives;
        [if cleared { -1 } else { first }, last - i32::from(self.flaw == Flaw::ShortLives)]
    }
}

/// A buffer or a texture of the graph's, and who has it when.
struct Memory {
    physical: Owned,
    users: Vec<(Part, Span)>,
}

enum Owned {
    Buffer(wgpu::Buffer),
    Texture(wgpu::Texture),
}

impl Memory {
    fn is_free(&self, at: i32) -> bool {
        self.users.iter().all(|(_, [first, last])| at < *first || at > *last)
    }

    /// What a pass of the host's does with memory that is its own now: NaN in every float, and no count that makes
    /// sense.
    fn spoil(&self, encoder: &mut wgpu::CommandEncoder, spoiled: &wgpu::Buffer) {
        match &self.physical {
            Owned::Buffer(buffer) => encoder.copy_buffer_to_buffer(spoiled, 0, buffer, 0, buffer.size()),
            Owned::Texture(texture) => encoder.copy_buffer_to_texture(
                wgpu::TexelCopyBufferInfo {
                    buffer: spoiled,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(texture.width() * 16),
                        rows_per_image: None,
                    },
                },
                texture.as_image_copy(),
                texture.size(),
            ),
        }
    }
}

/// Memory for the transients of a frame: as few buffers as their lifetimes allow, but for pairs that the node refuses.
fn assign(device: &wgpu::Device, graph: &Graph, parts: &[PartInfo], apart: &[[Part; 2]]) -> Vec<Memory> {
    let mut groups: Vec<(PartKind, Vec<(Part, Span)>)> = Vec::new();
    for info in parts.iter().filter(|info| matches!(info.lifetime, Lifetime::Transient { .. })) {
        let span = graph.span(info);
        let fits = |(kind, users): &&mut (PartKind, Vec<(Part, Span)>)| {
            let same_kind = match (*kind, info.kind) {
                (PartKind::Buffer { .. }, PartKind::Buffer { .. }) => true,
                (a, b) => a == b,
            };
            let refused = |other: Part| apart.iter().any(|pair| pair.contains(&other) && pair.contains(&info.part));
            same_kind
                && users.iter().all(|&(other, [first, last])| (span[1] < first || span[0] > last) && !refused(other))
        };
        match groups.iter_mut().find(fits) {
            Some((kind, users)) => {
                if info.kind.bytes() > kind.bytes() {
                    *kind = info.kind;
                }
                users.push((info.part, span));
            }
            None => groups.push((info.kind, vec![(info.part, span)])),
        }
    }
    let made = groups.into_iter().map(|(kind, users)| {
        let physical = match kind {
            PartKind::Buffer { bytes, .. } => {
                use wgpu::BufferUsages as Usage;
                Owned::Buffer(device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("graph"),
                    size: bytes,
                    usage: Usage::STORAGE | Usage::INDIRECT | Usage::COPY_DST,
                    mapped_at_creation: false,
                }))
            }
            PartKind::Texture { format, width, height, usage } => {
                Owned::Texture(device.create_texture(&wgpu::TextureDescriptor {
                    label: Some("graph"),
                    size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format,
                    usage: usage | wgpu::TextureUsages::COPY_DST,
                    view_formats: &[],
                }))
            }
        };
        Memory { physical, users }
    });
    made.collect()
}

/// Lends memory for all transients, each assigned by its lifetime.
fn lend(aa: &mut DeferredAa, device: &wgpu::Device, graph: &Graph, parts: &[PartInfo]) -> Vec<Memory> {
    let mut apart = Vec::new();
    loop {
        let memory = assign(device, graph, parts, &apart);
        let lent = |m: &'_ Memory| -> Vec<Part> { m.users.iter().map(|user| user.0).collect() };
        let lent: Vec<_> = memory
            .iter()
            .flat_map(|m| {
                let physical = match &m.physical {
                    Owned::Buffer(buffer) => Physical::Buffer(buffer),
                    Owned::Texture(texture) => Physical::Texture(texture),
                };
                lent(m).into_iter().map(move |part| Lent { part, memory: physical })
            })
            .collect();
        match aa.lend(device, &lent) {
            Ok(()) => return memory,
            Err(LendError::Together { part, other }) => apart.push([part, other]),
            Err(e) => panic!("{e}"),
        }
    }
}

/// What a frame by the graph came to.
#[derive(Debug, Default, Clone, Copy)]
struct Seen {
    left_out: usize,
    reordered: bool,
    /// Parts that share memory with another part.
    shared: usize,
    /// Times that a pass of the host's had a texture between two of the node's passes.
    between: usize,
}

/// A frame by the graph, on the host's own encoder.
fn record(
    aa: &mut DeferredAa,
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    encoder: &mut wgpu::CommandEncoder,
    frame: &Frame<'_>,
    (pick, flaw): (Pick, Flaw),
) -> Result<Seen, RecordError> {
    let passes = DeferredAa::passes(&frame.settings, &frame.needs).collect();
    let counts = frame.statistics || frame.settings.goal.is_some();
    let wanted: &[Resource] = if counts { &[Resource::Target, Resource::Statistics] } else { &[Resource::Target] };
    let graph = Graph::new(passes, wanted, pick, flaw);
    let parts = aa.parts(&frame.settings, &frame.needs);
    let memory = lend(aa, device, &graph, &parts);
    let size = parts.iter().map(|info| info.kind.bytes()).max().unwrap_or(0);
    let spoiled = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("spoiled"),
        size,
        usage: wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: true,
    });
    spoiled.get_mapped_range_mut(..).expect("mapped").slice(..).fill(0xff);
    spoiled.unmap();
    let mut seen = Seen {
        left_out: graph.left_out,
        reordered: graph.reordered,
        shared: memory.iter().map(|m| m.users.len()).filter(|&users| users > 1).sum(),
        between: 0,
    };
    let mut foreign = |encoder: &mut wgpu::CommandEncoder, at: i32| {
        for free in memory.iter().filter(|m| m.is_free(at)) {
            free.spoil(encoder, &spoiled);
            let texture = matches!(free.physical, Owned::Texture(_));
            seen.between += usize::from(texture && at >= 0 && at < graph.passes.len() as i32);
        }
    };
    // Before the frame nothing is alive.
    memory.iter().for_each(|m| m.spoil(encoder, &spoiled));
    let recording = aa.begin(queue, encoder, frame)?;
    for (at, pass) in (0..).zip(&graph.passes) {
        foreign(encoder, at);
        recording.record(encoder, *pass)?;
    }
    foreign(encoder, graph.passes.len() as i32);
    recording.finish(queue, encoder);
    Ok(seen)
}

fn by_graph(host: &mut Host, settings: Settings, statistics: bool, how: (Pick, Flaw)) -> Seen {
    let (device, camera) = (host.gpu.device.clone(), host.scene.default_camera());
    let mut seen = Seen::default();
    host.frame_by(&camera, settings, |aa, queue, encoder, frame| {
        let frame = Frame { statistics, ..*frame };
        seen = record(aa, &device, queue, encoder, &frame, how)?;
        Ok(())
    })
    .expect("a frame");
    assert_eq!(host.gpu.take_errors(), Vec::<String>::new());
    seen
}

/// The image by the graph is that of `record`, whatever the order, with and without rays, and the memory comes back.
fn compare(effect: Effect, tier: RayTier, ways: &[Settings]) {
    let scene = builtin("mirrors").unwrap();
    let camera = scene.default_camera();
    let mut host = host_on(scene, 2, SIZE, tier);
    let mut all = Seen::default();
    for &way in ways {
        let traced: &[DebugView] = if effect == Effect::Off { &[] } else { &[DebugView::Tiles, DebugView::Rays] };
        for &view in [DebugView::Image, DebugView::Count].iter().chain(traced) {
            let settings = Settings { view, shadows: effect, reflections: effect, refraction: effect, ..way };
            let whole = host.frame(&camera, settings).expect("a frame").statistics;
            let (expected, held) = (host.picture().rgba, host.aa.memory());
            for (statistics, pick) in [(true, Pick::Last), (false, Pick::Last), (false, Pick::Seeded(7))] {
                let seen = by_graph(&mut host, settings, statistics, (pick, Flaw::None));
                assert!(host.picture().rgba == expected, "{settings:?} {statistics} {pick:?}");
                if statistics {
                    let counted = host.aa.statistics().expect("statistics");
                    assert_eq!(
                        (&counted.histogram_k, counted.shadow_rays, counted.reflection_rays, counted.points),
                        (&whole.histogram_k, whole.shadow_rays, whole.reflection_rays, whole.points),
                    );
                    // Without samples beyond the points, nobody but the views of the plan and of rays reads what their
                    // colours are to the pixels.
                    let by_points = way.technique == Technique::MultiResolution && !way.multi_resolution.supersampled;
                    let of_tiles = view == DebugView::Tiles;
                    assert_eq!(seen.left_out, usize::from(by_points && of_tiles), "{settings:?}");
                }
                all.left_out += seen.left_out;
                all.reordered |= seen.reordered;
                all.shared += seen.shared;
                all.between += seen.between;
                let lent = host.aa.memory();
                assert!(lent.scratch < held.scratch && (effect == Effect::Off || lent.rays < held.rays), "{lent:?}");
                host.aa.lend(&host.gpu.device, &[]).expect("all of it back");
            }
        }
    }
    assert!(all.left_out > 0 && all.shared > 0 && all.between > 0 && all.reordered, "{all:?}");
}

#[test]
fn a_graph_that_reorders_culls_and_aliases_makes_the_same_image() {
    compare(Effect::Off, RayTier::Software, &ways());
}

#[test]
fn a_graph_that_reorders_culls_and_aliases_makes_the_same_image_with_rays() {
    compare(Effect::On, RayTier::Software, &ways());
}

#[test]
fn a_graph_makes_the_same_image_with_ray_query() {
    if tiers().contains(&RayTier::Query) {
        let techniques = [Technique::Windowed, Technique::Selective, Technique::MultiResolution];
        let ways = techniques.map(|technique| Settings { technique, ..Default::default() });
        compare(Effect::On, RayTier::Query, &ways);
    }
}

/// The audits are passes too, and what a goal comes to depends on every frame before.
#[test]
fn a_goal_comes_to_the_same_by_a_graph() {
    for effect in [Effect::Off, Effect::On] {
        let scene = || builtin("mirrors").unwrap();
        let camera = scene().default_camera();
        let (mut whole, mut parts) = (host(scene(), 2, SIZE), host(scene(), 2, SIZE));
        let goal = Some(Goal::Error(0.02));
        let settings =
            Settings { goal, shadows: effect, reflections: effect, refraction: effect, ..Default::default() };
        let mut efforts = Vec::new();
        for frame in 0..12 {
            let expected = whole.frame(&camera, settings).expect("a frame").statistics.goal;
            let pick = if frame % 2 == 0 { Pick::Last } else { Pick::Seeded(frame) };
            let seen = by_graph(&mut parts, settings, true, (pick, Flaw::None));
            assert_eq!(seen.left_out, 0);
            assert_eq!(parts.aa.statistics().expect("statistics").goal, expected, "{effect:?} {frame}");
            assert!(parts.picture().rgba == whole.picture().rgba, "{effect:?} {frame}");
            efforts.push(expected.expect("a goal").effort);
        }
        assert!(efforts.first() != efforts.last(), "{efforts:?}");
    }
}

/// The comparison sees what a graph gets wrong.
#[test]
fn a_graph_that_errs_makes_another_image() {
    let scene = builtin("mirrors").unwrap();
    let camera = scene.default_camera();
    let mut host = host(scene, 2, SIZE);
    let settings = Settings::default();
    host.frame(&camera, settings).expect("a frame");
    let expected = host.picture().rgba;
    for flaw in [Flaw::None, Flaw::Disorder, Flaw::ShortLives, Flaw::LateLives] {
        by_graph(&mut host, settings, false, (Pick::Last, flaw));
        assert_eq!(host.picture().rgba == expected, flaw == Flaw::None, "{flaw:?}");
    }
}

/// wgpu refuses a pass that binds a buffer to be read and to be written at once: `lend` refuses it first.
#[test]
fn parts_that_may_share_memory_are_never_bound_together() {
    const BUFFERS: [Part; 14] = [
        Part::WindowCounts,
        Part::Plan,
        Part::PixelListRows,
        Part::PixelListEntries,
        Part::PixelListWork,
        Part::SampleListRows,
        Part::SampleListEntries,
        Part::SampleListWork,
        Part::SampleListColors,
        Part::LatticePoints,
        Part::LatticeColors,
        Part::Tiles,
        Part::Shadows,
        Part::Reflections,
    ];
    use wgpu::BufferUsages as Usage;
    let scene = builtin("mirrors").unwrap();
    let camera = scene.default_camera();
    let mut host = host(scene, 2, [16, 16]);
    let shared = host.gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("graph"),
        size: 1 << 18,
        usage: Usage::STORAGE | Usage::INDIRECT | Usage::COPY_DST,
        mapped_at_creation: false,
    });
    let memory = Physical::Buffer(&shared);
    let device = host.gpu.device.clone();
    for way in ways() {
        let mut pairs = 0;
        host.frame_by(&camera, way, |aa, queue, encoder, frame| {
            for (i, &part) in BUFFERS.iter().enumerate() {
                for &other in &BUFFERS[..i] {
                    match aa.lend(&device, &[part, other].map(|part| Lent { part, memory })) {
                        Err(LendError::Together { .. }) => continue,
                        lent => lent.expect("a loan"),
                    }
                    pairs += 1;
                    // Never submitted: in some frames both live at once, and what they would hold is anything.
                    let mut dropped = device.create_command_encoder(&Default::default());
                    aa.record(queue, &mut dropped, frame)?;
                    drop(dropped.finish());
                }
            }
            aa.lend(&device, &[]).expect("all of it back");
            aa.record(queue, encoder, frame)
        })
        .unwrap_or_else(|e| panic!("{way:?}: {e}"));
        assert!(pairs > 30, "{pairs}");
    }
}
