//! The order of the frame's passes, and what each is called, reads and writes.

use crate::effects::Traced;
use crate::lattice::{self, Place, Use};
use crate::list;
use crate::listed::Listing;
use crate::pipeline::PassInfo;
use crate::resolve::Source;
use crate::scratch::ListKind;
use crate::settings::{DebugView, Execution, Goal, Settings, Technique};
use crate::shade::{self, Variant};
use crate::statistics::MAX_PASSES;
use crate::traces::Samples;
use crate::view::Seen;
use crate::{
    audit, bounce, classify, extra, first, map, max_filter, metrics, plan, points, reconstruct, refine, select, view,
};

/// A pass of the frame, in the order in which [`DeferredAa::passes`](crate::DeferredAa::passes) yields it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pass {
    /// What it is called, reads and writes.
    pub info: PassInfo,
    pub(super) step: Step,
    pub(super) index: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Step {
    Classify {
        bounces: bool,
    },
    Trace(Samples),
    Bounce(Samples),
    /// To a lattice.
    Refine(Use, Place),
    Points(Place),
    Map {
        supersampled: bool,
    },
    First,
    Metrics,
    MaxFilter,
    Plan,
    Select,
    List(ListKind),
    Shade(Variant),
    Listed(Listing),
    Reconstruct,
    /// `between`: quadrants that are not active are interpolated.
    Extra {
        between: bool,
    },
    Resolve(Source),
    View {
        first: bool,
        planned: bool,
        seen: Option<Seen>,
    },
    Audit,
}

/// The frame, top to bottom.
pub(super) fn order(settings: &Settings, traced: Traced) -> [Option<Step>; MAX_PASSES] {
    let technique = settings.technique;
    let lattices = &settings.multi_resolution;
    let refined = technique == Technique::MultiResolution;
    let windowed = technique == Technique::Windowed;
    let reconstructs = technique == Technique::Reconstructed;
    let selects = technique == Technique::Selective;
    let planned = windowed || (refined && lattices.supersampled);
    let first = !(refined || technique == Technique::Full && settings.view != DebugView::First);
    let (shade, source) = match (technique, settings.execution) {
        (Technique::Full, _) => (Some(Step::Shade(Variant::Full)), Source::Color),
        (Technique::Single, _) => (None, Source::First),
        (Technique::MultiResolution, _) if !planned => (None, Source::Lattice),
        (Technique::Windowed | Technique::MultiResolution, execution) => (Some(execute(execution)), Source::ByPlan),
        (Technique::Reconstructed, _) => (Some(Step::Reconstruct), Source::Color),
        (Technique::Selective, _) => {
            let between = settings.selective.bilinear;
            (Some(Step::Extra { between }), if between { Source::Color } else { Source::ByPlan })
        }
    };
    let list = match shade {
        Some(Step::Listed(listing)) => Some(Step::List(listing.kind())),
        Some(Step::Extra { .. }) => Some(Step::List(ListKind::Pixels)),
        _ => None,
    };
    let filtered = planned && settings.execution == Execution::MaxFiltered;
    let audited = windowed && matches!(settings.goal, Some(Goal::Error(_)));
    let cast =
        |samples| [traced.shadows.then_some(Step::Trace(samples)), traced.secondary.then_some(Step::Bounce(samples))];
    let before = if technique == Technique::Full { Samples::Full } else { Samples::First };
    let beyond = if reconstructs { Samples::Geometric } else { Samples::Planned };
    let more = planned || reconstructs || selects;
    // Lattices cast by points, not by tiles.
    let classifies = traced.any() && (!refined || more);
    let seen = match settings.view {
        DebugView::Tiles => classifies.then_some(Seen::Tiles),
        DebugView::Shadows => traced.shadows.then_some(Seen::Traced),
        DebugView::Rays => traced.any().then_some(Seen::Traced),
        _ => None,
    };

    let mut steps = Steps::default();
    steps.add(classifies.then_some(Step::Classify { bounces: traced.secondary }));
    if refined {
        for (i, place) in lattice::places(lattices, Use::Rays).filter(|_| traced.any()).enumerate() {
            steps.add((i > 0).then_some(Step::Refine(Use::Rays, place)));
            steps.extend(cast(Samples::Points(place)));
        }
        for (i, place) in lattice::places(lattices, Use::Shading).enumerate() {
            steps.add((i > 0).then_some(Step::Refine(Use::Shading, place)));
            steps.add(Some(Step::Points(place)));
        }
        let maps = planned || settings.view != DebugView::Image;
        steps.add(maps.then_some(Step::Map { supersampled: planned }));
    } else {
        steps.extend(cast(before));
    }
    steps.extend([
        first.then_some(Step::First),
        selects.then_some(Step::Select),
        windowed.then_some(Step::Metrics),
        filtered.then_some(Step::MaxFilter),
        planned.then_some(Step::Plan),
    ]);
    if more {
        steps.extend(cast(beyond));
    }
    steps.extend([
        list,
        shade,
        Some(match settings.view {
            DebugView::Image => Step::Resolve(source),
            _ => Step::View { first: first || refined, planned: more || refined, seen },
        }),
    ]);
    if audited {
        // Behind the image, which does not wait for it.
        steps.extend(cast(Samples::Audited));
        steps.add(Some(Step::Audit));
    }
    steps.steps
}

/// Steps as they are added.
#[derive(Default)]
struct Steps {
    steps: [Option<Step>; MAX_PASSES],
    count: usize,
}

impl Steps {
    fn add(&mut self, step: Option<Step>) {
        if step.is_some() {
            self.steps[self.count] = step;
            self.count += 1;
        }
    }

    fn extend(&mut self, steps: impl IntoIterator<Item = Option<Step>>) {
        steps.into_iter().for_each(|step| self.add(step));
    }
}

fn execute(execution: Execution) -> Step {
    match execution {
        Execution::Loop | Execution::MaxFiltered => Step::Shade(Variant::Loop),
        Execution::Tiled => Step::Shade(Variant::Tiled),
        Execution::Bucketed => Step::Listed(Listing::Bucketed),
        Execution::Sorted => Step::Listed(Listing::Sorted),
        Execution::Packed => Step::Listed(Listing::Packed),
    }
}

impl Step {
    /// Whether the host's code runs in it.
    pub fn shades(self) -> bool {
        matches!(
            self,
            Self::Bounce(_)
                | Self::First
                | Self::Shade(_)
                | Self::Listed(_)
                | Self::Reconstruct
                | Self::Points(_)
                | Self::Extra { .. }
                | Self::Audit
        )
    }

    /// Which of its pipelines it takes for samples that bring `traced` along. What it reads and writes may differ where its
    /// pipeline does not.
    pub fn variant(self, traced: Traced) -> (Self, Traced) {
        let of = if self.reads_traced() { traced } else { Traced::default() };
        let step = match self {
            Self::Classify { .. } => Self::Classify { bounces: false },
            Self::Trace(_) => Self::Trace(Samples::First),
            Self::Bounce(_) => Self::Bounce(Samples::First),
            Self::Refine(of, _) => Self::Refine(of, Place::Pixels),
            Self::Points(_) => Self::Points(Place::Pixels),
            Self::Map { .. } => Self::Map { supersampled: false },
            Self::View { .. } => Self::View { first: false, planned: false, seen: None },
            own => own,
        };
        (step, of)
    }

    /// Whether it shades the frame's samples, or judges them, which bring along what was traced.
    pub fn reads_traced(self) -> bool {
        matches!(self, Self::Metrics | Self::Select | Self::Refine(Use::Shading, _))
            || (self.shades() && !matches!(self, Self::Bounce(_)))
    }

    pub fn info(self, traced: Traced) -> PassInfo {
        let traced = traced.any();
        match self {
            Self::Classify { .. } => classify::INFO,
            Self::Trace(samples) => samples.info(),
            Self::Bounce(samples) => bounce::info(samples),
            Self::Refine(of, place) => refine::info(of, place, traced),
            Self::Points(place) => points::info(place, traced),
            Self::Map { supersampled: true } => map::INFO_SUPERSAMPLED,
            Self::Map { .. } => map::INFO,
            Self::First if traced => first::INFO_TRACED,
            Self::First => first::INFO,
            Self::Metrics if traced => metrics::INFO_TRACED,
            Self::Metrics => metrics::INFO,
            Self::MaxFilter => max_filter::INFO,
            Self::Plan => plan::INFO,
            Self::Select if traced => select::INFO_TRACED,
            Self::Select => select::INFO,
            Self::List(_) => list::INFO,
            Self::Listed(listing) => listing.info(traced),
            Self::Shade(Variant::Full) if traced => shade::INFO_FULL_TRACED,
            Self::Shade(Variant::Full) => shade::INFO_FULL,
            Self::Shade(_) if traced => shade::INFO_TRACED,
            Self::Shade(_) => shade::INFO,
            Self::Reconstruct if traced => reconstruct::INFO_TRACED,
            Self::Reconstruct => reconstruct::INFO,
            Self::Extra { .. } if traced => extra::INFO_TRACED,
            Self::Extra { .. } => extra::INFO,
            Self::Resolve(source) => source.info(),
            Self::View { first, planned, seen } => view::info(first, planned, seen),
            Self::Audit if traced => audit::INFO_TRACED,
            Self::Audit => audit::INFO,
        }
    }
}
