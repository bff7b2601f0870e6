//! The renderer behind the window, on a thread and a device of its own: however long a frame, a compilation or a
//! reference takes, the window answers.
//!
//! The window says what it wants, not what to do: the thread compares that with what it has, and does the most urgent
//! thing that is missing, one frame at a time. So nothing queues up while a slider moves.

mod event;
mod frames;
mod peers;
mod recipe;
mod shared;
mod slices;
mod stage;
mod thread;
mod wanted;
mod worker;

pub use event::{Event, Opened, Rendered, casts};
pub use recipe::{Maker, Recipe};
pub use wanted::{Lights, Reference, Source, View, Wanted, same, to_sun};
pub use worker::Worker;
