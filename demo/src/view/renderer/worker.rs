//! The handle of the renderer's thread.

use super::event::Event;
use super::shared::Shared;
use super::thread::Renderer;
use super::wanted::Wanted;
use crate::host::Options;
use crate::view::priority::step_back;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Condvar, Mutex};
use std::thread::JoinHandle;

/// The thread's handle. Dropped, it ends the thread after the frame under way.
#[derive(Debug)]
pub struct Worker {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts it. `wake` is called after each event.
    pub fn start(
        wanted: Wanted,
        options: Options,
        adapter: Option<String>,
        events: Sender<Event>,
        wake: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let shared = Arc::new(Shared { wanted: Mutex::new(wanted), changed: Condvar::new() });
        let own = shared.clone();
        let thread = std::thread::Builder::new().name("renderer".to_owned()).spawn(move || {
            step_back();
            let say = move |event| {
                // The window may be gone.
                let _ = events.send(event);
                wake();
            };
            Renderer::new(own, options, adapter, Box::new(say)).run();
        })?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Says what is wanted from now on.
    pub fn want(&self, change: impl FnOnce(&mut Wanted)) {
        change(&mut self.shared.lock());
        self.shared.changed.notify_one();
    }

    /// Whether it ended.
    pub fn ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.want(|wanted| wanted.quit = true);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
