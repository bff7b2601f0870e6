//! What the window's thread and the renderer's have in common.

use super::wanted::Wanted;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// What is wanted, and the news that it has changed.
#[derive(Debug)]
pub struct Shared {
    pub wanted: Mutex<Wanted>,
    pub changed: Condvar,
}

impl Shared {
    /// What is wanted; a panic of the other thread makes no difference to it.
    pub fn lock(&self) -> MutexGuard<'_, Wanted> {
        self.wanted.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
