//! What the user does: keys, flying, dialogs and their answers.

mod actions;
mod answers;
pub mod dialog;
pub mod fly;
mod keys;
