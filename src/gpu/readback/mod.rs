//! What comes back from the GPU, without a wait.

pub(crate) mod collector;
pub(crate) mod input_check;
pub(crate) mod read_back;
