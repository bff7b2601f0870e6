//! What the renderer is at, and what there is to say.

use std::time::{Duration, Instant};

/// Most lines of the log.
const MOST_MESSAGES: usize = 200;

/// How long the newest message is shown on the picture.
const RECENT: Duration = Duration::from_secs(8);

/// The state of the renderer, in words.
pub struct Status {
    /// The log, the newest line last.
    pub messages: Vec<String>,
    said_at: Instant,
    /// What the renderer is at; empty for nothing.
    pub busy: &'static str,
    busy_since: Instant,
    /// Nothing will be rendered any more, and why.
    pub failed: Option<String>,
}

impl Status {
    /// As the viewer starts.
    pub fn opening() -> Self {
        Self {
            messages: Vec::new(),
            said_at: Instant::now(),
            busy: "opening",
            busy_since: Instant::now(),
            failed: None,
        }
    }

    /// Adds a line to the log.
    pub fn say(&mut self, message: String) {
        self.messages.push(message);
        self.said_at = Instant::now();
        if self.messages.len() > MOST_MESSAGES {
            self.messages.remove(0);
        }
    }

    /// The newest message, for a while.
    pub fn recent(&self) -> Option<&str> {
        self.messages.last().filter(|_| self.said_at.elapsed() < RECENT).map(String::as_str)
    }

    /// Adds a notice about the scene to the log, which holds all of them.
    pub fn note(&mut self, notice: &str) {
        self.messages.push(format!("note: {notice}"));
    }

    /// The renderer has begun something else.
    pub fn is_at(&mut self, busy: &'static str) {
        (self.busy, self.busy_since) = (busy, Instant::now());
    }

    /// What the renderer is at, and for how long where that makes one wonder.
    pub fn busy_text(&self) -> String {
        match self.busy_since.elapsed().as_secs() {
            0..3 => format!("{}…", self.busy),
            seconds => format!("{}… {seconds} s", self.busy),
        }
    }
}
