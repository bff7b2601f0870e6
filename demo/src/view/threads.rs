//! The threads behind the window, and what goes back and forth.

use super::judge::{Judge, Verdict};
use super::renderer::{Event, Wanted, Worker, same};
use crate::host::Options;
use egui::Context;
use std::sync::mpsc::{Receiver, channel};

/// The renderer and the judge.
pub struct Threads {
    worker: Worker,
    events: Receiver<Event>,
    pub judge: Judge,
    verdicts: Receiver<Verdict>,
    /// What the renderer was told last.
    sent: Option<Box<Wanted>>,
    hears: bool,
}

impl Threads {
    /// Starts both. They wake the window when they have something to say.
    pub fn start(ctx: &Context, wanted: Wanted, options: Options, adapter: Option<String>) -> std::io::Result<Self> {
        let (say, events) = channel();
        let waker = ctx.clone();
        let worker = Worker::start(wanted, options, adapter, say, move || waker.request_repaint())?;
        let (say, verdicts) = channel();
        let waker = ctx.clone();
        let judge = Judge::start(say, move || waker.request_repaint())?;
        Ok(Self { worker, events, judge, verdicts, sent: None, hears: true })
    }

    /// What the renderer has said next.
    pub fn event(&self) -> Option<Event> {
        self.events.try_recv().ok()
    }

    /// What the judge has said next.
    pub fn verdict(&self) -> Option<Verdict> {
        self.verdicts.try_recv().ok()
    }

    /// Whether the renderer has ended since this was asked before.
    pub fn have_ended(&mut self) -> bool {
        self.hears && self.worker.ended() && std::mem::replace(&mut self.hears, false)
    }

    /// Tells the renderer what is wanted, if that has changed.
    pub fn want(&mut self, next: Wanted) {
        if !self.sent.as_deref().is_some_and(|sent| same(sent, &next)) {
            self.sent = Some(Box::new(next.clone()));
            self.worker.want(|wanted| *wanted = next);
        }
    }
}
