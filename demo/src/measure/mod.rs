//! What is measured of pictures and frames, and what they are held against.

pub mod goal;
pub mod oracle;
pub mod quality;
pub mod reference;
pub mod stats;
pub mod temporal;
