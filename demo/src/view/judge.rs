//! Measures pictures against the reference on a thread of its own: FLIP takes longer than a frame.

use super::priority::step_back;
use crate::measure::quality::{self, Quality};
use crate::picture::{Picture, display};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;

/// A picture and what it is held against.
#[derive(Debug, Clone)]
pub struct Case {
    /// The side of the divider.
    pub side: usize,
    /// The picture.
    pub picture: Arc<Picture>,
    /// The reference.
    pub reference: Arc<Picture>,
}

/// What came out of a case.
#[derive(Debug)]
pub struct Verdict {
    /// The case that was measured.
    pub case: Case,
    /// How near it is, or why that can't be said.
    pub quality: Result<Quality, String>,
    /// Where it is wrong: 8 bits a channel, rows from the top, black where the displayed values are the same and red,
    /// yellow, white from an error of 1/64 on.
    pub error: Vec<[u8; 3]>,
}

#[derive(Debug, Default)]
struct Waiting {
    /// The newest case of each side.
    cases: [Option<Case>; 2],
    quit: bool,
}

/// The thread's handle. Dropped, it ends it.
#[derive(Debug)]
pub struct Judge {
    shared: Arc<(Mutex<Waiting>, Condvar)>,
    thread: Option<JoinHandle<()>>,
}

impl Judge {
    /// Starts it. `wake` is called after each verdict.
    pub fn start(verdicts: Sender<Verdict>, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let shared = Arc::new((Mutex::new(Waiting::default()), Condvar::new()));
        let own = shared.clone();
        let thread = std::thread::Builder::new().name("judge".to_owned()).spawn(move || {
            step_back();
            while let Some(case) = next(&own) {
                let _ = verdicts.send(judge(case));
                wake();
            }
        })?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Measures a picture; one of the same side that still waits is left out.
    pub fn measure(&self, case: Case) {
        let (waiting, changed) = &*self.shared;
        let side = case.side;
        waiting.lock().unwrap_or_else(PoisonError::into_inner).cases[side] = Some(case);
        changed.notify_one();
    }
}

impl Drop for Judge {
    fn drop(&mut self) {
        self.shared.0.lock().unwrap_or_else(PoisonError::into_inner).quit = true;
        self.shared.1.notify_one();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn next((waiting, changed): &(Mutex<Waiting>, Condvar)) -> Option<Case> {
    let mut guard = waiting.lock().unwrap_or_else(PoisonError::into_inner);
    loop {
        if guard.quit {
            return None;
        }
        if let Some(case) = guard.cases.iter_mut().find_map(Option::take) {
            return Some(case);
        }
        guard = changed.wait(guard).unwrap_or_else(PoisonError::into_inner);
    }
}

fn judge(case: Case) -> Verdict {
    let quality = quality::compare(&case.picture, &case.reference, None).map_err(|e| e.to_string());
    let pairs = case.picture.rgba.iter().zip(&case.reference.rgba);
    let error = pairs.map(|(a, b)| heat(apart(*a, *b))).collect();
    Verdict { case, quality, error }
}

/// The greatest difference of a channel as displayed, 0 to 1.
fn apart(a: [f32; 4], b: [f32; 4]) -> f32 {
    let [a, b] = [a, b].map(|[r, g, b, _]| display([r, g, b]));
    (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f32::max)
}

/// 0 black, 1/64 red, 1/16 yellow, 1/4 and more white.
fn heat(error: f32) -> [u8; 3] {
    let stops = [1.0 / 64.0, 1.0 / 16.0, 0.25];
    let mut from = 0.0;
    stops.map(|stop| {
        let part = ((error - from) / (stop - from)).clamp(0.0, 1.0);
        from = stop;
        (part * 255.0 + 0.5) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_seen_where_they_are() {
        assert_eq!(heat(0.0), [0, 0, 0]);
        assert_eq!(heat(1.0 / 64.0), [255, 0, 0]);
        assert_eq!(heat(1.0 / 16.0), [255, 255, 0]);
        assert_eq!(heat(0.5), [255, 255, 255]);
        let grey = |v: f32| [v, v, v, 1.0];
        let picture = |last: f32| Arc::new(Picture { width: 2, height: 1, rgba: vec![grey(0.5), grey(last)] });
        let (verdicts, found) = std::sync::mpsc::channel();
        let judge = Judge::start(verdicts, || {}).unwrap();
        let case = Case { side: 1, picture: picture(0.9), reference: picture(0.1) };
        judge.measure(case);
        let verdict = found.recv().unwrap();
        assert_eq!(verdict.case.side, 1);
        assert_eq!(verdict.error[0], [0, 0, 0]);
        assert_eq!(verdict.error[1], [255, 255, 255]);
        assert!(verdict.quality.unwrap().psnr_db.unwrap() < 20.0);
    }
}
