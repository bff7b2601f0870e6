//! The pipelines of all passes: compiled when a frame first needs them, or behind the frames while others serve.

use super::order::{Step, order};
use crate::audit::Audit;
use crate::bounce::Bounce;
use crate::classify::Classify;
use crate::effects::Traced;
use crate::error::RecordError;
use crate::extra::Extra;
use crate::first::First;
use crate::list::Lists;
use crate::listed::Listed;
use crate::map::Map;
use crate::max_filter::MaxFilter;
use crate::metrics::Metrics;
use crate::pipeline::{Build, PassInfo};
use crate::plan::Plan;
use crate::points::Points;
use crate::rays::RayTier;
use crate::reconstruct::Reconstruct;
use crate::refine::Refine;
use crate::resolve::Resolve;
use crate::select::Select;
use crate::settings::Settings;
use crate::shade::Shade;
use crate::shader::Shader;
use crate::trace::Trace;
use crate::view::View;
use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// All passes, and what they build on.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub build: Build,
    pub first: First,
    pub metrics: Metrics,
    pub max_filter: MaxFilter,
    pub plan: Plan,
    pub lists: Lists,
    pub shade: Shade,
    pub listed: Listed,
    pub reconstruct: Reconstruct,
    pub select: Select,
    pub extra: Extra,
    pub refine: Refine,
    pub points: Points,
    pub map: Map,
    pub resolve: Resolve,
    pub view: View,
    pub audit: Audit,
    pub tracing: Option<Tracing>,
    /// What is compiled.
    compiled: Mutex<HashSet<(Step, Traced)>>,
    /// A thread compiles.
    compiling: AtomicBool,
}

/// What traces, in a node that may.
#[derive(Debug)]
pub(super) struct Tracing {
    pub tier: RayTier,
    pub classify: Classify,
    pub trace: Trace,
    pub bounce: Bounce,
}

impl Pipelines {
    pub fn new(build: Build, rays: Option<RayTier>) -> Self {
        let device = &build.device;
        Self {
            first: First::new(device),
            metrics: Metrics::new(device),
            max_filter: MaxFilter::new(device),
            plan: Plan::new(device),
            lists: Lists::new(device),
            shade: Shade::new(device),
            listed: Listed::new(device),
            reconstruct: Reconstruct::new(device),
            select: Select::new(device),
            extra: Extra::new(device),
            refine: Refine::new(device),
            points: Points::new(device),
            map: Map::new(device),
            resolve: Resolve::new(device),
            view: View::new(device),
            audit: Audit::new(device),
            tracing: rays.map(|tier| Tracing {
                tier,
                classify: Classify::new(device),
                trace: Trace::new(device, tier),
                bounce: Bounce::new(device, tier),
            }),
            compiled: Mutex::default(),
            compiling: AtomicBool::new(false),
            build,
        }
    }

    /// Compiles what frames with these settings and this traced want, where it is not yet.
    pub fn warm_up(&self, settings: &Settings, traced: Traced) -> Result<(), RecordError> {
        for step in order(settings, traced).into_iter().flatten() {
            let key = step.variant(traced);
            if !self.has(key) {
                self.compile(step, traced)?;
                self.compiled.lock().unwrap_or_else(PoisonError::into_inner).insert(key);
            }
        }
        Ok(())
    }

    /// What each pass of frames with these settings and this traced runs. Compiles them anew, so that each pass has all of its
    /// own.
    pub fn shaders(&self, settings: &Settings, traced: Traced) -> Result<Vec<(PassInfo, Vec<Shader>)>, RecordError> {
        let tier = self.tracing.as_ref().map(|tracing| tracing.tier);
        let steps = order(settings, traced).into_iter().flatten();
        let pass = |step: Step| {
            let one = Self::new(self.build.keeping(), tier);
            match (step, &one.tracing) {
                // Frames have both ready.
                (Step::Classify { bounces }, Some(tracing)) => tracing.classify.compile(&one.build, bounces)?,
                _ => one.compile(step, traced)?,
            }
            Ok((step.info(traced), one.build.shaders.take()))
        };
        steps.map(pass).collect()
    }

    fn has(&self, key: (Step, Traced)) -> bool {
        self.compiled.lock().unwrap_or_else(PoisonError::into_inner).contains(&key)
    }

    /// Whether the passes of a frame that gets `traced` are compiled, those that shade for samples that bring `set` along.
    pub fn ready(&self, settings: &Settings, traced: Traced, set: Traced) -> bool {
        order(settings, traced).into_iter().flatten().all(|step| self.has(step.variant(set)))
    }

    /// Whose pipelines a frame that gets `traced` takes: its own, or, while these are compiled on a thread, those of a larger
    /// set, which find that nothing was traced of the rest. Waits for the compiler only if there are none of either.
    pub fn serve(self: &Arc<Self>, settings: &Settings, traced: Traced) -> Result<Traced, RecordError> {
        if self.ready(settings, traced, traced) {
            return Ok(traced);
        }
        let larger = Traced::ALL.into_iter().find(|&set| set.contains(traced) && self.ready(settings, traced, set));
        let Some(larger) = larger else { return self.warm_up(settings, traced).map(|()| traced) };
        if !self.compiling.swap(true, Ordering::AcqRel) {
            let (own, wanted) = (self.clone(), *settings);
            let behind = move || {
                // If it fails it is not tried again: the larger set goes on to serve.
                if own.warm_up(&wanted, traced).is_ok() {
                    own.compiling.store(false, Ordering::Release);
                }
            };
            if std::thread::Builder::new().name("daa compile".to_owned()).spawn(behind).is_err() {
                // There are no threads here.
                self.compiling.store(false, Ordering::Release);
                return self.warm_up(settings, traced).map(|()| traced);
            }
        }
        Ok(larger)
    }

    fn compile(&self, step: Step, traced: Traced) -> Result<(), RecordError> {
        let build = &self.build;
        let tracing = || self.tracing.as_ref().ok_or(RecordError::NoRays);
        match step {
            Step::Classify { .. } => tracing()?.classify.warm_up(build)?,
            Step::Trace(_) => {
                let tracing = tracing()?;
                tracing.trace.pipeline(build, tracing.tier)?;
            }
            Step::Bounce(_) => {
                let tracing = tracing()?;
                if !build.host.bounces {
                    return Err(RecordError::NoBounce);
                }
                tracing.bounce.pipeline(build, tracing.tier)?;
            }
            Step::Refine(of, _) => self.refine.warm_up(build, of, traced)?,
            Step::Points(_) => drop(self.points.pipeline(build, traced)?),
            Step::Map { .. } => drop(self.map.pipeline(build)?),
            Step::First => drop(self.first.pipeline(build, traced)?),
            Step::Metrics => drop(self.metrics.pipeline(build, traced)?),
            Step::MaxFilter => drop(self.max_filter.pipeline(build)?),
            Step::Plan => drop(self.plan.pipeline(build)?),
            Step::List(kind) => self.lists.warm_up(build, kind)?,
            Step::Listed(listing) => self.listed.warm_up(build, listing, traced)?,
            Step::Shade(variant) => drop(self.shade.pipeline(build, variant, traced)?),
            Step::Reconstruct => drop(self.reconstruct.pipeline(build, traced)?),
            Step::Select => drop(self.select.pipeline(build, traced)?),
            Step::Extra { between } => self.extra.warm_up(build, between, traced)?,
            Step::Resolve(source) => drop(self.resolve.pipeline(build, source)?),
            Step::View { .. } => drop(self.view.pipeline(build)?),
            Step::Audit => drop(self.audit.pipeline(build, traced)?),
        }
        Ok(())
    }
}
