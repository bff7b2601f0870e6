//! The window: winit's events to egui, egui's shapes to wgpu.

use super::app::{App, Start};
use super::tour::Tour;
use egui::epaint::textures::TexturesDelta;
use egui::{Context, ViewportId};
use egui_wgpu::winit::Painter;
use egui_wgpu::{RendererOptions, SurfaceConfig, WgpuConfiguration, WgpuSetup};
use std::num::NonZeroU32;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy, OwnedDisplayHandle};
use winit::window::{Window, WindowId};

/// The viewer could not be shown, or had to end.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// No display, most often.
    #[error("no window can be opened: {0}; where there is no display, use the commands demo and render, or Xvfb")]
    NoWindow(String),
    /// The window's device.
    #[error("the window can't be drawn: {0}; settings are saved")]
    Drawing(String),
    /// A thread.
    #[error("no thread for the renderer: {0}")]
    Thread(std::io::Error),
    /// What a tour found.
    #[error("the tour found {} faults, the first: {}", .0.len(), .0.first().map_or("", String::as_str))]
    Tour(Vec<String>),
}

/// Opens the window; back when it is closed. `tour`: moves every control through its range, and ends.
pub fn run(start: Start, tour: bool) -> Result<(), ViewError> {
    let event_loop = EventLoop::<Wake>::with_user_event().build().map_err(|e| ViewError::NoWindow(one_line(&e)))?;
    let ctx = Context::default();
    let proxy = event_loop.create_proxy();
    wake_by(&ctx, proxy);
    let mut shell = Shell {
        display: event_loop.owned_display_handle(),
        ctx,
        start: Some(start),
        tour: tour.then(Tour::new),
        shown: None,
        repaint_at: None,
        trouble: Arc::default(),
        outcome: Ok(()),
    };
    event_loop.run_app(&mut shell).map_err(|e| ViewError::NoWindow(one_line(&e)))?;
    shell.outcome
}

fn one_line(e: &dyn std::fmt::Display) -> String {
    let text = e.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    // winit puts the place in its own source before what is wrong.
    match text.strip_prefix("os error at ").and_then(|text| text.split_once(": ")) {
        Some((_, wrong)) => wrong.to_owned(),
        None => text,
    }
}

/// Something wants the window drawn, at once or later.
#[derive(Debug, Clone, Copy)]
struct Wake(Duration);

fn wake_by(ctx: &Context, proxy: EventLoopProxy<Wake>) {
    // From any thread, so the loop may have to be woken.
    let proxy = Mutex::new(proxy);
    ctx.set_request_repaint_callback(move |info| {
        let _ = proxy.lock().unwrap_or_else(PoisonError::into_inner).send_event(Wake(info.delay));
    });
}

struct Shown {
    window: Arc<Window>,
    painter: Painter,
    input: egui_winit::State,
    app: App,
    /// Not on the device yet.
    textures: TexturesDelta,
}

impl Drop for Shown {
    fn drop(&mut self) {
        // It panics if textures are left that nobody wants any more.
        self.textures.clear();
    }
}

struct Shell {
    display: OwnedDisplayHandle,
    ctx: Context,
    start: Option<Start>,
    tour: Option<Tour>,
    shown: Option<Shown>,
    repaint_at: Option<Instant>,
    /// What the window's device complained of.
    trouble: Arc<Mutex<Option<String>>>,
    outcome: Result<(), ViewError>,
}

impl Shell {
    fn open(&mut self, event_loop: &ActiveEventLoop, start: Start) -> Result<Shown, ViewError> {
        let monitor = event_loop.primary_monitor().or_else(|| event_loop.available_monitors().next());
        let room = monitor.map(|monitor| monitor.size().to_logical::<f32>(monitor.scale_factor()).into());
        let [width, height] = opening(start.kept.window, room);
        let attributes = Window::default_attributes()
            .with_title("deferred-aa")
            .with_inner_size(LogicalSize::new(width, height))
            .with_min_inner_size(LogicalSize::new(480.0, 320.0));
        let window = event_loop.create_window(attributes).map_err(|e| ViewError::NoWindow(one_line(&e)))?;
        let window = Arc::new(window);
        let configuration = WgpuConfiguration {
            wgpu_setup: WgpuSetup::from_display_handle(self.display.clone()),
            surface: SurfaceConfig::LOW_LATENCY,
            ..WgpuConfiguration::default()
        };
        let painter = Painter::new(self.ctx.clone(), configuration, false, RendererOptions::default());
        let mut painter = pollster::block_on(painter);
        let set = painter.set_window(ViewportId::ROOT, Some(window.clone()));
        pollster::block_on(set).map_err(|e| ViewError::Drawing(one_line(&e)))?;
        if let Some(state) = painter.render_state() {
            let log = self.trouble.clone();
            let note = move |text: String| {
                log.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(text);
            };
            let lost = note.clone();
            state.device.set_device_lost_callback(move |reason, message| lost(format!("{reason:?} {message}")));
            state.device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| note(one_line(&e))));
        }
        let input = egui_winit::State::new(
            self.ctx.clone(),
            ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            window.theme(),
            painter.max_texture_side(),
        );
        let app = App::new(&self.ctx, start).map_err(ViewError::Thread)?;
        Ok(Shown { window, painter, input, app, textures: TexturesDelta::default() })
    }

    fn end(&mut self, event_loop: &ActiveEventLoop, outcome: Result<(), ViewError>) {
        if let Some(shown) = &mut self.shown {
            shown.app.save();
        }
        if self.outcome.is_ok() {
            self.outcome = outcome;
        }
        // The renderer ends before the event loop does.
        self.shown = None;
        event_loop.exit();
    }

    fn draw(&mut self, event_loop: &ActiveEventLoop) {
        let trouble = self.trouble.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(why) = trouble {
            return self.end(event_loop, Err(ViewError::Drawing(why)));
        }
        let Some(Shown { window, painter, input, app, textures }) = &mut self.shown else { return };
        let raw = input.take_egui_input(window);
        let mut output = self.ctx.run_ui(raw, |ui| app.ui(ui));
        input.handle_platform_output_with_event_loop(window, event_loop, std::mem::take(&mut output.platform_output));
        textures.append(std::mem::take(&mut output.textures_delta));
        let shapes = self.ctx.tessellate(output.shapes, output.pixels_per_point);
        let ground = self.ctx.global_style().visuals.panel_fill.to_normalized_gamma_f32();
        painter.paint_and_update_textures(
            ViewportId::ROOT,
            output.pixels_per_point,
            ground,
            &shapes,
            textures,
            Vec::new(),
            window,
        );
        let delay = output.viewport_output.get(&ViewportId::ROOT).map_or(Duration::MAX, |o| o.repaint_delay);
        self.wake_in(delay);
        if let (Some(tour), Some(shown)) = (&mut self.tour, &mut self.shown)
            && tour.advance(&mut shown.app)
        {
            let faults = std::mem::take(&mut tour.faults);
            let outcome = if faults.is_empty() { Ok(()) } else { Err(ViewError::Tour(faults)) };
            self.end(event_loop, outcome);
        }
    }

    fn wake_in(&mut self, delay: Duration) {
        let at = Instant::now().checked_add(delay);
        self.repaint_at = match (self.repaint_at, at) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
    }
}

impl ApplicationHandler<Wake> for Shell {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        let Some(start) = self.start.take() else { return };
        match self.open(event_loop, start) {
            Ok(shown) => {
                shown.window.request_redraw();
                self.shown = Some(shown);
            }
            Err(e) => {
                self.outcome = Err(e);
                event_loop.exit();
            }
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, Wake(delay): Wake) {
        self.wake_in(delay);
    }

    fn new_events(&mut self, _: &ActiveEventLoop, _: StartCause) {
        if self.repaint_at.is_some_and(|at| at <= Instant::now()) {
            self.repaint_at = None;
            if let Some(shown) = &mut self.shown {
                if shown.app.hidden {
                    // No redraw comes while the window is not seen.
                    shown.app.receive(&self.ctx);
                } else {
                    shown.window.request_redraw();
                }
            }
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        if self.tour.is_some() {
            self.wake_in(Duration::from_millis(2));
        }
        event_loop.set_control_flow(self.repaint_at.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(shown) = &mut self.shown else { return };
        match &event {
            WindowEvent::CloseRequested => return self.end(event_loop, Ok(())),
            WindowEvent::RedrawRequested => return self.draw(event_loop),
            WindowEvent::Resized(size) => {
                // 0 where it is minimised.
                shown.app.hidden = size.width == 0 || size.height == 0;
                shown.app.sync();
                if let (Some(width), Some(height)) = (NonZeroU32::new(size.width), NonZeroU32::new(size.height)) {
                    shown.painter.on_window_resized(ViewportId::ROOT, width, height);
                    let logical = size.to_logical::<f32>(shown.window.scale_factor());
                    shown.app.kept.window = [logical.width.max(480.0), logical.height.max(320.0)];
                }
            }
            WindowEvent::Occluded(hidden) => {
                shown.app.hidden = *hidden;
                shown.app.sync();
            }
            _ => {}
        }
        if shown.input.on_window_event(&shown.window, &event).repaint {
            shown.window.request_redraw();
        }
    }
}

/// The size of a new window in points: as it is remembered, but no larger than its screen, where that is known.
fn opening(kept: [f32; 2], screen: Option<[f32; 2]>) -> [f32; 2] {
    let Some(screen) = screen.filter(|screen| screen.iter().all(|side| *side >= 1.0)) else { return kept };
    // A desktop has bars and a window has a frame.
    [kept[0].min(screen[0] * 0.98), kept[1].min(screen[1] * 0.92)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_opens_no_larger_than_its_screen() {
        assert_eq!(opening([1440.0, 900.0], Some([800.0, 500.0])), [784.0, 460.0]);
        assert_eq!(opening([1440.0, 900.0], Some([2560.0, 1440.0])), [1440.0, 900.0]);
        for unknown in [None, Some([0.0, 0.0])] {
            assert_eq!(opening([1440.0, 900.0], unknown), [1440.0, 900.0]);
        }
    }

    #[test]
    fn an_error_is_one_line_without_the_place_in_a_library() {
        let wrong = "neither WAYLAND_DISPLAY nor DISPLAY is set";
        assert_eq!(one_line(&format!("os error at /a/winit/src/mod.rs:765: {wrong}")), wrong);
        assert_eq!(one_line(&format!("winit:\n  {wrong}")), format!("winit: {wrong}"));
    }
}
