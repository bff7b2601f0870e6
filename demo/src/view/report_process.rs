//! A report of what is seen, measured in a process of its own.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::JoinHandle;

/// A report under way. Dropped, it ends the process, which has its own progress to resume from.
pub struct Report {
    child: Child,
    folder: PathBuf,
    /// What it says is wrong, read as it comes, so that it never waits for a reader.
    errors: Option<JoinHandle<String>>,
}

impl Report {
    /// Runs this program with these arguments, which name the folder.
    pub fn begin(arguments: &[String], folder: &Path) -> std::io::Result<Self> {
        let exe = std::env::current_exe()?;
        let mut child = Command::new(exe).args(arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn()?;
        let errors = child.stderr.take().map(|mut stderr| {
            std::thread::spawn(move || {
                let mut said = Vec::new();
                // What was read before an error is what there is.
                let _ = stderr.read_to_end(&mut said);
                String::from_utf8_lossy(&said).into_owned()
            })
        });
        Ok(Self { child, folder: folder.to_owned(), errors })
    }

    /// How it ended, if it has.
    pub fn ended(&mut self) -> std::io::Result<Option<ExitStatus>> {
        self.child.try_wait()
    }

    /// What there is to say of one that has ended: where the page is, or what went wrong.
    pub fn outcome(&mut self, status: ExitStatus) -> Result<String, String> {
        let errors = self.errors.take().and_then(|thread| thread.join().ok()).unwrap_or_default();
        if status.success() {
            return Ok(format!("the report is there: {}", self.folder.join("report.html").display()));
        }
        let why = errors.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or_default();
        Err(format!("the report ended with {status}: {why}"))
    }
}

impl Drop for Report {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
