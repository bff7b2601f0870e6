//! All tests that need a GPU or real files, as one binary. Every test that renders checks at its end that wgpu had
//! nothing to complain of.

mod api;
mod bands;
mod bits;
mod blend;
mod campaigns;
mod checker;
mod debug_views;
mod depth;
mod example;
mod goals;
mod graph;
mod harness;
mod multi_resolution;
mod needs;
mod numerics;
mod rays;
mod reflections;
mod reflections_twin;
mod scenes;
mod selective;
mod shading_errors;
mod shadows;
mod surfaces;
mod textures;
mod twin;
mod views;
mod visibility;
