//! What the viewer knows: its sides, what they are held against, how they are looked at, and what is remembered.

mod comparison;
mod kept;
mod look;
mod side;
mod status;
mod tone;

pub use comparison::{Comparison, Tried};
pub use kept::{Kept, path as kept_path};
pub use look::Look;
pub use side::Side;
pub use status::Status;
pub use tone::{Channel, Tone};
