//! The pipelines of all passes. They are compiled when a frame first needs them, or on a thread while a larger set is
//! used.

use crate::gpu::binding::{self, PassData};
use crate::gpu::modules::{self, Base, Tiers};
use crate::gpu::step::Step;
use crate::host::error::{PipelineError, RecordError};
use crate::host::gbuffer::{GBuffer, GBufferTier, Ids};
use crate::host::graph::{Grid, PassKind, Stage};
use crate::host::needs::RayInputs;
use crate::host::shader::Shader;
use crate::rays::RayTier;
use crate::wgsl::HostSource;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, PoisonError, RwLock};

/// The inputs of all pipelines.
#[derive(Debug)]
pub(crate) struct Build {
    pub device: wgpu::Device,
    pub m: u32,
    pub host: HostSource,
    pub target_format: wgpu::TextureFormat,
    pub gbuffer: GBufferTier,
    /// How rays are traced, if the node can trace any.
    pub rays: Option<RayTier>,
    /// The layouts of `@group(0)`, by [`RayInputs::index`].
    pub frame_layouts: [wgpu::BindGroupLayout; RayInputs::COUNT],
    /// The layout of `@group(1)`: the texture table, or the host's second group.
    pub second_layout: Option<wgpu::BindGroupLayout>,
    /// The layout of `@group(2)`: the host's.
    pub host_layout: Option<wgpu::BindGroupLayout>,
}

/// A compiled stage.
#[derive(Debug, Clone)]
pub(crate) struct Pipeline {
    pub kind: PipelineKind,
    /// The layout of its own group.
    pub layout: wgpu::BindGroupLayout,
}

#[derive(Debug, Clone)]
pub(crate) enum PipelineKind {
    Compute(wgpu::ComputePipeline),
    Render(wgpu::RenderPipeline),
}

/// The key of a pipeline: the module, the entry point, and the ray results of its samples. Stages of several passes may
/// share a pipeline.
type Key = (&'static str, &'static str, RayInputs);

fn key(pass: &PassData, stage: &Stage, set: RayInputs) -> Key {
    (pass.module.name, stage.entry, if pass.reads_found() { set } else { RayInputs::default() })
}

/// All pipelines, and their inputs.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub build: Build,
    compiled: RwLock<HashMap<Key, Pipeline>>,
    /// Whether a thread is compiling.
    compiling: AtomicBool,
}

impl Pipelines {
    pub fn new(build: Build) -> Self {
        Self { build, compiled: RwLock::default(), compiling: AtomicBool::new(false) }
    }

    /// Compiles a pass that shades, for an error where the host's layout does not fit its WGSL.
    pub fn try_host(&self, pass: &PassData) -> Result<(), PipelineError> {
        let inputs = RayInputs::default();
        for stage in pass.stages {
            let made = self.build.compile_on(self.build.rays.unwrap_or_default(), pass, stage, inputs)?;
            let mut compiled = self.compiled.write().unwrap_or_else(PoisonError::into_inner);
            compiled.insert(key(pass, stage, inputs), made);
        }
        Ok(())
    }

    fn has(&self, key: &Key) -> bool {
        self.compiled.read().unwrap_or_else(PoisonError::into_inner).contains_key(key)
    }

    /// The pipeline of a stage, for samples with the ray results `set`. It is compiled if it is not yet.
    pub fn get(&self, pass: &'static PassData, stage: &'static Stage, set: RayInputs) -> Result<Pipeline, RecordError> {
        let key = key(pass, stage, set);
        if let Some(found) = self.compiled.read().unwrap_or_else(PoisonError::into_inner).get(&key) {
            return Ok(found.clone());
        }
        // Two threads may compile the same pipeline; the second result is dropped.
        let made = self.build.compile(pass, stage, key.2)?;
        let mut compiled = self.compiled.write().unwrap_or_else(PoisonError::into_inner);
        Ok(compiled.entry(key).or_insert(made).clone())
    }

    /// Compiles the pipelines of frames with these steps and inputs that are not compiled yet.
    pub fn warm_up(&self, steps: &[Step], inputs: RayInputs) -> Result<(), RecordError> {
        for step in steps {
            for stage in step.pass.stages {
                self.get(step.pass, stage, inputs)?;
            }
        }
        Ok(())
    }

    /// Whether the stages of a frame are compiled, for samples with the ray results `set`.
    pub fn ready(&self, steps: &[Step], set: RayInputs) -> bool {
        let stages = steps.iter().flat_map(|step| step.pass.stages.iter().map(|stage| key(step.pass, stage, set)));
        stages.into_iter().all(|key| self.has(&key))
    }

    /// Chooses pipelines, and returns the ray results that they were compiled for: a superset of the frame's. While the
    /// frame's own pipelines are compiled on a thread, those of a larger set are used, which find that the rest was not
    /// traced. Waits for the compiler only if neither are there.
    pub fn serve(self: &Arc<Self>, steps: &[Step], inputs: RayInputs) -> Result<RayInputs, RecordError> {
        if self.ready(steps, inputs) {
            return Ok(inputs);
        }
        let larger = RayInputs::ALL.into_iter().find(|&set| set.contains(inputs) && self.ready(steps, set));
        let Some(larger) = larger else { return self.warm_up(steps, inputs).map(|()| inputs) };
        if !self.compiling.swap(true, Ordering::AcqRel) {
            let (own, wanted) = (self.clone(), steps.to_vec());
            let behind = move || {
                // If it fails, it is not tried again, and the larger set stays in use.
                if own.warm_up(&wanted, inputs).is_ok() {
                    own.compiling.store(false, Ordering::Release);
                }
            };
            if std::thread::Builder::new().name("daa compile".to_owned()).spawn(behind).is_err() {
                // This platform has no threads.
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
            (Base::Casting { shades: true }, Some(_)) if !self.host.reflects => Err(RecordError::NoReflection),
            (Base::Casting { .. }, None) => Err(RecordError::NoRays),
            (_, tier) => Ok(tier.unwrap_or_default()),
        }
    }

    fn constants(&self, pass: &PassData) -> Vec<(&'static str, f64)> {
        let mut constants = vec![("DAA_M", f64::from(self.m))];
        if let Some(Ids::Narrow { triangle_bits }) = self.gbuffer.ids() {
            constants.push(("DAA_TRIANGLE_BITS", f64::from(triangle_bits)));
        }
        if pass.kind == PassKind::Resolve {
            constants.push(("DAA_TARGET_MAX", f64::from(target_max(self.target_format))));
        }
        constants
    }

    /// Only the crate's own modules rely on workgroup memory that is initialised to 0; modules with the host's source
    /// write it before they read it.
    fn zeroed(&self, pass: &PassData) -> bool {
        !modules::binds_host(pass.module.base, &self.host)
    }

    fn compile(&self, pass: &PassData, stage: &Stage, set: RayInputs) -> Result<Pipeline, RecordError> {
        Ok(self.compile_on(self.admit(pass)?, pass, stage, set)?)
    }

    fn compile_on(
        &self,
        tier: RayTier,
        pass: &PassData,
        stage: &Stage,
        set: RayInputs,
    ) -> Result<Pipeline, PipelineError> {
        let text = modules::source(pass.module, &self.host, set, Tiers { gbuffer: self.gbuffer, rays: tier });
        let name = pass.module.name;
        self.checked(name, || {
            let own = binding::layout(&self.device, pass, stage, tier);
            let hosts = modules::binds_host(pass.module.base, &self.host);
            let host = |layout: &'_ Option<wgpu::BindGroupLayout>| layout.clone().filter(|_| hosts);
            let (second, host) = (host(&self.second_layout), host(&self.host_layout));
            let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(name),
                bind_group_layouts: &[
                    Some(&self.frame_layouts[set.index()]),
                    second.as_ref(),
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
        })
    }

    /// Creates a pipeline that covers the target, or the depth texture, with one triangle.
    fn fullscreen(
        &self,
        stage: &Stage,
        layout: &wgpu::PipelineLayout,
        module: &wgpu::ShaderModule,
        options: &wgpu::PipelineCompilationOptions<'_>,
    ) -> wgpu::RenderPipeline {
        let depth = (stage.grid == Grid::Depth).then(|| wgpu::DepthStencilState {
            depth_compare: Some(wgpu::CompareFunction::Always),
            ..GBuffer::depth_state()
        });
        let color = [Some(self.target_format.into())];
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
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(stage.entry),
                compilation_options: options.clone(),
                targets: if depth.is_some() { &[] } else { &color },
            }),
            depth_stencil: depth,
            multiview_mask: None,
            cache: None,
        })
    }

    /// The shaders of a pass, for a host that compiles them itself. Each is also compiled here, to check it.
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
                source: modules::source(pass.module, &self.host, set, Tiers { gbuffer: self.gbuffer, rays: tier }),
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

    /// Catches errors of wgpu, so that a host's mistake is returned as an error.
    fn checked<T>(&self, pass: &'static str, make: impl FnOnce() -> T) -> Result<T, PipelineError> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = make();
        match ready(scope.pop()) {
            None => Ok(made),
            Some(e) => Err(PipelineError { pass, message: one_line(&e) }),
        }
    }
}

/// The greatest finite value of a colour format.
fn target_max(format: wgpu::TextureFormat) -> f32 {
    match format {
        wgpu::TextureFormat::Rgba16Float | wgpu::TextureFormat::Rg16Float | wgpu::TextureFormat::R16Float => 65504.0,
        wgpu::TextureFormat::Rg11b10Ufloat => 64512.0,
        wgpu::TextureFormat::Rgba32Float | wgpu::TextureFormat::Rg32Float | wgpu::TextureFormat::R32Float => 1e30,
        _ => 1.0,
    }
}

/// The entry point of fullscreen.wgsl.
const FULLSCREEN_VERTEX: &str = "daa_fullscreen_vertex";

/// The message of wgpu in one line.
pub(crate) fn one_line(error: &wgpu::Error) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The result of an error scope. On native backends it is available at once. In a browser it comes later, and the error
/// goes to the console instead.
pub(crate) fn ready(pop: impl Future<Output = Option<wgpu::Error>>) -> Option<wgpu::Error> {
    let mut pop = std::pin::pin!(pop);
    match pop.as_mut().poll(&mut std::task::Context::from_waker(std::task::Waker::noop())) {
        std::task::Poll::Ready(error) => error,
        std::task::Poll::Pending => None,
    }
}
