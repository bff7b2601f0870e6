//! The CPU twin: every pass again in f64, to be read beside its shader. Tests compare the two.
//!
//! The twin takes the input of the GPU pass (the G-buffer's bits, S, the counts) and computes its expected output. k is
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
pub mod sample;
pub mod selective;
pub mod surfaces;
pub mod triangle;
pub mod visibility;
pub mod window;

pub use resolve::depth;
