//! placeholder
use super::stage::Stage;
pub(super) fn build() -> Stage { super::spheres::build() }
