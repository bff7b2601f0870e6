//! The pipelines of all passes: compiled when a frame first needs them, or behind the frames while others serve.

use crate::gpu::binding::{self, PassData};
use crate::gpu::modules::{self, Base};
use crate::gpu::step::Step;
use crate::host::error::{PipelineError, RecordError};
use crate::host::graph::{PassKind, Stage};
use crate::host::needs::RayInputs;
use crate::host::shader::Shader;
use crate::passes::resolve::target_max;
use crate::rays::RayTier;
use crate::wgsl::HostSource;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, PoisonError, RwLock};

/// What every pipeline is built from.
#[derive(Debug)]
pub(crate) struct Build {
    pub device: wgpu::Device,
    pub m: u32,
    pub host: HostSource,
    pub target_format: wgpu::TextureFormat,
    /// Who traces rays, in a node that may.
    pub rays: Option<RayTier>,
    /// `@group(0)`, by [`RayInputs::index`].
    pub frame_layouts: [wgpu::BindGroupLayout; RayInputs::COUNT],
    /// `@group(1)`: the texture table.
    pub table_layout: Option<wgpu::BindGroupLayout>,
    /// `@group(2)`: the host's.
    pub host_layout: Option<wgpu::BindGroupLayout>,
}

/// A compiled stage.
#[derive(Debug, Clone)]
pub(crate) struct Pipeline {
    pub kind: PipelineKind,
    /// Of its own group.
    pub layout: wgpu::BindGroupLayout,
}

#[derive(Debug, Clone)]
pub(crate) enum PipelineKind {
    Compute(wgpu::ComputePipeline),
    Render(wgpu::RenderPipeline),
}

/// Stages of several passes may share a pipeline: what tells pipelines apart is the module, the entry point, and the inputs that its
/// samples bring along.
type Key = (&'static str, &'static str, RayInputs);

fn key(pass: &PassData, stage: &Stage, set: RayInputs) -> Key {
    (pass.module.name, stage.entry, if pass.reads_found() { set } else { RayInputs::default() })
}

/// All pipelines, and what they are built from.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub build: Build,
    compiled: RwLock<HashMap<Key, Pipeline>>,
    /// A thread compiles.
    compiling: AtomicBool,
}

impl Pipelines {
    pub fn new(build: Build) -> Self {
        Self { build, compiled: RwLock::default(), compiling: AtomicBool::new(false) }
    }

    fn has(&self, key: &Key) -> bool {
        self.compiled.read().unwrap_or_else(PoisonError::into_inner).contains_key(key)
    }

    /// Of a stage whose samples bring `set` along; compiles it if it is not yet.
    pub fn get(&self, pass: &'static PassData, stage: &'static Stage, set: RayInputs) -> Result<Pipeline, RecordError> {
        let key = key(pass, stage, set);
        if let Some(found) = self.compiled.read().unwrap_or_else(PoisonError::into_inner).get(&key) {
            return Ok(found.clone());
        }
        // Two threads may both compile it: the second one's is dropped.
        let made = self.build.compile(pass, stage, key.2)?;
        let mut compiled = self.compiled.write().unwrap_or_else(PoisonError::into_inner);
        Ok(compiled.entry(key).or_insert(made).clone())
    }

    /// Compiles what frames with these steps and inputs want, where it is not yet.
    pub fn warm_up(&self, steps: &[Step], inputs: RayInputs) -> Result<(), RecordError> {
        for step in steps {
            for stage in step.pass.stages {
                self.get(step.pass, stage, inputs)?;
            }
        }
        Ok(())
    }

    /// Whether the stages of a frame are compiled, for samples that bring `set` along.
    pub fn ready(&self, steps: &[Step], set: RayInputs) -> bool {
        let stages = steps.iter().flat_map(|step| step.pass.stages.iter().map(|stage| key(step.pass, stage, set)));
        stages.into_iter().all(|key| self.has(&key))
    }

    /// The inputs that the chosen pipelines were compiled for; a superset of the frame's. While its own pipelines are compiled on a
    /// thread, those of a larger set serve, which find that nothing was traced of the rest. Waits for the compiler only if there are
    /// none of either.
    pub fn serve(self: &Arc<Self>, steps: &[Step], inputs: RayInputs) -> Result<RayInputs, RecordError> {
        if self.ready(steps, inputs) {
            return Ok(inputs);
        }
        let larger = RayInputs::ALL.into_iter().find(|&set| set.contains(inputs) && self.ready(steps, set));
        let Some(larger) = larger else { return self.warm_up(steps, inputs).map(|()| inputs) };
        if !self.compiling.swap(true, Ordering::AcqRel) {
            let (own, wanted) = (self.clone(), steps.to_vec());
            let behind = move || {
                // If it fails it is not tried again: the larger set goes on to serve.
                if own.warm_up(&wanted, inputs).is_ok() {
                    own.compiling.store(false, Ordering::Release);
                }
            };
            if std::thread::Builder::new().name("daa compile".to_owned()).spawn(behind).is_err() {
                // There are no threads here.
                self.compiling.store(false, Ordering::Release);
                return self.warm_up(steps, inputs).map(|()| inputs);
            }
        }
        Ok(larger)
    }
}

impl Build {
    /// Refuses passes that this node can't run.
    fn admit(&self, pass: &PassData) -> Result<RayTier, RecordError> {
        match (pass.module.base, self.rays) {
            (Base::Casting { shades: true }, Some(_)) if !self.host.bounces => Err(RecordError::NoBounce),
            (Base::Casting { .. }, None) => Err(RecordError::NoRays),
            (_, tier) => Ok(tier.unwrap_or_default()),
        }
    }

    fn constants(&self, pass: &PassData) -> Vec<(&'static str, f64)> {
        let mut constants = vec![("DAA_M", f64::from(self.m))];
        if pass.kind == PassKind::Resolve {
            constants.push(("DAA_TARGET_MAX", f64::from(target_max(self.target_format))));
        }
        constants
    }

    /// Only modules of the crate's own count up from 0 in workgroup memory; what the host's read there they have written.
    fn zeroed(&self, pass: &PassData) -> bool {
        !modules::binds_host(pass.module.base, &self.host)
    }

    fn compile(&self, pass: &PassData, stage: &Stage, set: RayInputs) -> Result<Pipeline, RecordError> {
        let tier = self.admit(pass)?;
        let text = modules::source(pass.module, &self.host, set, tier);
        let name = pass.module.name;
        let checked = self.checked(name, || {
            let own = binding::layout(&self.device, pass, stage, tier);
            let hosts = modules::binds_host(pass.module.base, &self.host);
            let host = |layout: &'_ Option<wgpu::BindGroupLayout>| layout.clone().filter(|_| hosts);
            let (table, host) = (host(&self.table_layout), host(&self.host_layout));
            let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(name),
                bind_group_layouts: &[
                    Some(&self.frame_layouts[set.index()]),
                    table.as_ref(),
                    host.as_ref(),
                    Some(&own),
                ],
                immediate_size: 0,
            });
            let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(name),
                source: wgpu::ShaderSource::Wgsl(text.into()),
            });
            let constants = self.constants(pass);
            let options = wgpu::PipelineCompilationOptions {
                constants: &constants,
                zero_initialize_workgroup_memory: self.zeroed(pass),
            };
            let kind = if pass.draws() {
                PipelineKind::Render(self.fullscreen(stage, &layout, &module, &options))
            } else {
                PipelineKind::Compute(self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(stage.entry),
                    layout: Some(&layout),
                    module: &module,
                    entry_point: Some(stage.entry),
                    compilation_options: options,
                    cache: None,
                }))
            };
            Pipeline { kind, layout: own }
        })?;
        Ok(checked)
    }

    /// A pipeline that covers the target with one triangle.
    fn fullscreen(
        &self,
        stage: &Stage,
        layout: &wgpu::PipelineLayout,
        module: &wgpu::ShaderModule,
        options: &wgpu::PipelineCompilationOptions<'_>,
    ) -> wgpu::RenderPipeline {
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(stage.entry),
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(FULLSCREEN_VERTEX),
                compilation_options: options.clone(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(stage.entry),
                compilation_options: options.clone(),
                targets: &[Some(self.target_format.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    /// What the stages of a pass run, for a host that compiles them by itself. Compiles each as its only check.
    pub fn shaders(&self, step: &Step, name: &'static str, inputs: RayInputs) -> Result<Vec<Shader>, RecordError> {
        let pass = step.pass;
        let set = if pass.reads_found() { inputs } else { RayInputs::default() };
        let mut shaders = Vec::new();
        for stage in pass.stages {
            let tier = self.admit(pass)?;
            self.compile(pass, stage, set)?;
            let shader = |entry: &str, shader_stage| Shader {
                pass: name,
                entry: entry.to_owned(),
                stage: shader_stage,
                source: modules::source(pass.module, &self.host, set, tier),
                constants: self.constants(pass).into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
                zero_initialize_workgroup_memory: self.zeroed(pass),
            };
            if pass.draws() {
                shaders.push(shader(FULLSCREEN_VERTEX, naga::ShaderStage::Vertex));
                shaders.push(shader(stage.entry, naga::ShaderStage::Fragment));
            } else {
                shaders.push(shader(stage.entry, naga::ShaderStage::Compute));
            }
        }
        Ok(shaders)
    }

    /// Catches what wgpu says, so that a host's mistake comes back as an error.
    fn checked<T>(&self, pass: &'static str, make: impl FnOnce() -> T) -> Result<T, PipelineError> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = make();
        match ready(scope.pop()) {
            None => Ok(made),
            Some(e) => Err(PipelineError { pass, message: one_line(&e) }),
        }
    }
}

/// Of fullscreen.wgsl.
const FULLSCREEN_VERTEX: &str = "daa_fullscreen_vertex";

/// What wgpu said.
pub(crate) fn one_line(error: &wgpu::Error) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The outcome of an error scope. On native backends it is there at once; in a browser it comes later, and the error goes
/// to the console instead.
pub(crate) fn ready(pop: impl Future<Output = Option<wgpu::Error>>) -> Option<wgpu::Error> {
    let mut pop = std::pin::pin!(pop);
    match pop.as_mut().poll(&mut std::task::Context::from_waker(std::task::Waker::noop())) {
        std::task::Poll::Ready(error) => error,
        std::task::Poll::Pending => None,
    }
}
