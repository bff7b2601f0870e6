//! The parts of work of a report, each of which keeps what it has finished.
//!
//! ```text
//! truth       what all entries are held against, from the cache if it is there
//! entries     the entries, interleaved by the window's size
//! bounds      how few samples could have done
//! flicker     the same entries while the camera moves
//! executions, goals, cost   the same image run in other ways; to a goal; on other sizes, lights, triangles
//! effects     what the scene does not pay for
//! papers      the tables of the papers, and the same rows here
//! ```

pub mod bounds;
pub mod cost;
pub mod effects;
pub mod entries;
pub mod executions;
pub mod fit;
pub mod flicker;
pub mod goals;
pub mod papers;
pub mod shooter;
pub mod truth;
pub mod variants;
