//! The CPU twin: every pass again in f64, to be read beside its shader and held against it by tests.
//!
//! The twin takes what the GPU pass took (the G-buffer's bits, S, the counts) and says what it should have made of it. k is
//! an integer, so both must agree, except where the metric lies within [`metrics::ROUNDING_BAND`] of a half.

pub mod audit;
pub mod check;
pub mod list;
pub mod max_filter;
pub mod metrics;
pub mod multi_resolution;
pub mod octahedral;
pub mod plan;
pub mod rays;
pub mod reconstruct;
pub mod resolve;
pub mod selective;
pub mod window;
