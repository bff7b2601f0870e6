//! `view`: every setting on a control, two of them side by side, what each costs and how near it comes, live.
//!
//! The window (`window`) draws on a device of its own what `app` shows. The renderer (`worker`) has its own thread and device, so
//! that the window answers however long a frame takes; the measuring (`judge`) has its own thread.

mod app;
mod controls;
mod cost_panel;
mod dialog;
mod fly;
mod judge;
mod kept;
mod picture_panel;
mod rust_source;
mod settings_panel;
mod side;
mod tour;
mod window;
mod worker;

pub use app::Start;
pub use kept::{Kept, path as kept_path};
pub use window::{ViewError, run};
pub use worker::Source;

/// Puts this thread, and those that it starts, behind the window's: a driver that renders on the processor would keep it waiting.
fn step_back() {
    // Linux counts it by thread. It may be refused, and only delays.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::setpriority_process(None, 10);
}
