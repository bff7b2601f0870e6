//! `view`: every setting on a control, two of them side by side, what each costs and how near it comes, live.
//!
//! The window (`window`) draws on a device of its own what `app` shows. The renderer (`renderer`) has its own thread
//! and device, so that the window answers however long a frame takes; the measuring (`judge`) has its own thread.

mod app;
mod controls;
mod input;
mod judge;
mod panels;
mod picture;
mod priority;
mod renderer;
mod report_process;
mod rust_source;
mod state;
#[cfg(test)]
mod tests;
mod threads;
mod tour;
mod wants;
mod window;

pub use app::Start;
pub use renderer::Source;
pub use state::{Kept, kept_path};
pub use window::{ViewError, run};
