//! A report of what is seen, measured in a process of its own.

use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

/// A report under way. Dropped, it ends the process, which has its own progress to resume from.
pub struct Report {
    child: Child,
    folder: PathBuf,
    /// The last line that it said: how far it has come, or at its end what is wrong.
    said: Arc<Mutex<String>>,
    /// Reads what it says as it comes, so that it never waits for a reader.
    reader: Option<JoinHandle<()>>,
}

impl Report {
    /// Runs this program with these arguments, which name the folder.
    pub fn begin(arguments: &[String], folder: &Path) -> std::io::Result<Self> {
        let exe = std::env::current_exe()?;
        let mut child = Command::new(exe).args(arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn()?;
        let said = Arc::new(Mutex::new(String::new()));
        let last = said.clone();
        let reader = child.stderr.take().map(|stderr| {
            std::thread::spawn(move || {
                // What was read before an error is what there is.
                let lines = BufReader::new(stderr).split(b'\n').map_while(Result::ok);
                for line in lines.map(|line| String::from_utf8_lossy(&line).trim().to_owned()) {
                    if !line.is_empty() {
                        *last.lock().unwrap_or_else(PoisonError::into_inner) = line;
                    }
                }
            })
        });
        Ok(Self { child, folder: folder.to_owned(), said, reader })
    }

    /// How it ended, if it has.
    pub fn ended(&mut self) -> std::io::Result<Option<ExitStatus>> {
        self.child.try_wait()
    }

    /// What there is to say of one that has ended: where the page is, or what went wrong.
    pub fn outcome(&mut self, status: ExitStatus) -> Result<String, String> {
        let _ = self.reader.take().map(JoinHandle::join);
        if status.success() {
            return Ok(format!("the report is there: {}", self.folder.join("report.html").display()));
        }
        Err(format!("the report ended with {status}: {}", self.said()))
    }

    /// The last line that it said: how far it has come and how long it may take, while it runs.
    pub fn said(&self) -> String {
        self.said.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Its folder, which keeps what is finished.
    pub fn folder(&self) -> &Path {
        &self.folder
    }
}

impl Drop for Report {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
