//! What accuracy costs: techniques over their settings, measured, and a page that shows it.
//!
//! ```text
//! plan        which entries, before any work
//! parts       the parts of work: the truth, the entries, and each further question
//! schema      the rows that the parts give, and report.json as a whole
//! page        report.html; table: the same on a terminal
//! run         the order of all of it
//! ```
//!
//! What is finished is in the folder at once ([`folder`]), so that nothing is measured twice after an interruption.

pub mod cache;
mod error;
pub mod fingerprint;
pub mod folder;
mod page;
pub mod parts;
pub mod plan;
pub mod run;
pub mod schema;
pub mod session;
pub mod table;

pub use error::ReportError;
