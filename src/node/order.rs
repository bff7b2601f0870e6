//! The order of the frame's passes, and what each is called, reads and writes.

use crate::effects::Traced;
use crate::list;
use crate::listed::{self, Listing};
use crate::pipeline::PassInfo;
use crate::resolve::Source;
use crate::scratch::ListKind;
use crate::settings::{DebugView, Execution, Goal, Settings, Technique};
use crate::shade::{self, Variant};
use crate::statistics::MAX_PASSES;
use crate::traces::Samples;
use crate::{audit, bounce, classify, extra, first, max_filter, metrics, plan, reconstruct, select, view};

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
    Classify { bounces: bool },
    Trace(Samples),
    Bounce(Samples),
    First,
    Metrics,
    MaxFilter,
    Plan,
    Select,
    List(ListKind),
    Shade(Variant),
    Listed(Listing),
    Reconstruct,
    Extra,
    Resolve(Source),
    View { first: bool, planned: bool },
    Audit,
}

/// The frame, top to bottom.
pub(super) fn order(settings: &Settings, traced: Traced) -> [Option<Step>; MAX_PASSES] {
    let planned = settings.technique == Technique::Windowed;
    let first = settings.technique != Technique::Full || settings.view == DebugView::First;
    let (shade, source) = match (settings.technique, settings.execution) {
        (Technique::Full, _) => (Some(Step::Shade(Variant::Full)), Source::Color),
        (Technique::Single, _) => (None, Source::First),
        (Technique::Windowed, execution) => (Some(execute(execution)), Source::ByPlan),
        (Technique::Reconstructed, _) => (Some(Step::Reconstruct), Source::Color),
        (Technique::Selective, _) => (Some(Step::Extra), Source::Color),
    };
    let list = match shade {
        Some(Step::Listed(listing)) => Some(Step::List(listing.kind())),
        _ => None,
    };
    let filtered = planned && settings.execution == Execution::MaxFiltered;
    let audited = planned && matches!(settings.goal, Some(Goal::Error(_)));
    let trace = |samples, when| (when && traced.shadows).then_some(Step::Trace(samples));
    let bounce = |samples, when| (when && traced.secondary).then_some(Step::Bounce(samples));
    let before = if settings.technique == Technique::Full { Samples::Full } else { Samples::First };
    let reconstructs = settings.technique == Technique::Reconstructed;
    let selects = settings.technique == Technique::Selective;
    let more = planned || reconstructs || selects;
    let beyond = if reconstructs { Samples::Geometric } else { Samples::Planned };
    [
        traced.any().then_some(Step::Classify { bounces: traced.secondary }),
        trace(before, true),
        bounce(before, true),
        first.then_some(Step::First),
        if selects { Some(Step::Select) } else { planned.then_some(Step::Metrics) },
        filtered.then_some(Step::MaxFilter),
        planned.then_some(Step::Plan),
        trace(beyond, more),
        bounce(beyond, more),
        list,
        shade,
        Some(match settings.view {
            DebugView::Image => Step::Resolve(source),
            _ => Step::View { first, planned: more },
        }),
        // Behind the image, which does not wait for it.
        trace(Samples::Audited, audited),
        bounce(Samples::Audited, audited),
        audited.then_some(Step::Audit),
    ]
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
                | Self::Extra
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
            Self::View { .. } => Self::View { first: false, planned: false },
            own => own,
        };
        (step, of)
    }

    /// Whether it shades the frame's samples, or judges them, which bring along what was traced.
    pub fn reads_traced(self) -> bool {
        matches!(self, Self::Metrics | Self::Select) || (self.shades() && !matches!(self, Self::Bounce(_)))
    }

    pub fn info(self, traced: Traced) -> PassInfo {
        let traced = traced.any();
        match self {
            Self::Classify { .. } => classify::INFO,
            Self::Trace(samples) => samples.info(),
            Self::Bounce(samples) => bounce::info(samples),
            Self::First if traced => first::INFO_TRACED,
            Self::First => first::INFO,
            Self::Metrics if traced => metrics::INFO_TRACED,
            Self::Metrics => metrics::INFO,
            Self::MaxFilter => max_filter::INFO,
            Self::Plan => plan::INFO,
            Self::Select if traced => select::INFO_TRACED,
            Self::Select => select::INFO,
            Self::List(_) => list::INFO,
            Self::Listed(_) if traced => listed::INFO_TRACED,
            Self::Listed(_) => listed::INFO,
            Self::Shade(Variant::Full) if traced => shade::INFO_FULL_TRACED,
            Self::Shade(Variant::Full) => shade::INFO_FULL,
            Self::Shade(_) if traced => shade::INFO_TRACED,
            Self::Shade(_) => shade::INFO,
            Self::Reconstruct if traced => reconstruct::INFO_TRACED,
            Self::Reconstruct => reconstruct::INFO,
            Self::Extra if traced => extra::INFO_TRACED,
            Self::Extra => extra::INFO,
            Self::Resolve(source) => source.info(),
            Self::View { first, planned } => view::info(first, planned),
            Self::Audit if traced => audit::INFO_TRACED,
            Self::Audit => audit::INFO,
        }
    }
}
