//! The standing figures of an adapter: techniques and presets on built-in scenes, by pass, within a number of minutes.

mod plan;
mod run;
mod schema;
mod table;

pub use plan::{Cell, Plan};
pub use run::run;
pub use schema::{Bench, LeftOut, Measured, Row};
pub use table::{heading, ratios, table};
