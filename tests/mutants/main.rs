//! `./x mutants [--driver NAME] [NAMES]`: breaks the project in one way after another, and runs the tests that must
//! notice.
//!
//! A mutant is a patch in this folder. The lines above it say what it breaks and what must go red:
//!
//! ```text
//! Row: the hard case
//! Test: suite numerics::limits::row_19   the tests of tests/suite whose name holds that; `lib` and `demo` for the unit
//!                                        tests of the library and of the demo; one of several lines must go red
//! Driver: swiftshader                    only on that driver
//! Equivalent: why nothing can notice it; the mutant is listed and not run
//! ```
//!
//! Mutants of Rust are built in a copy of the tree. A shader lies as it is in the test's executable, so a mutant of
//! shaders is written over it there, which takes no build.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Output, Stdio};
use std::time::{Duration, Instant};
use std::{env, fs, thread};

/// Tests that run longer hang.
const MOST: Duration = Duration::from_secs(900);

fn main() -> ExitCode {
    match run() {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(e) => {
            eprintln!("mutants: {e}");
            ExitCode::from(2)
        }
    }
}

/// The number of mutants that survived.
fn run() -> Result<usize, String> {
    let mut arguments: Vec<String> = env::args().skip(1).collect();
    let mut driver = None;
    if arguments.first().is_some_and(|a| a == "--driver") {
        driver = arguments.drain(..2.min(arguments.len())).nth(1);
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let wanted = |m: &Mutant| {
        m.driver == driver && (arguments.is_empty() || arguments.iter().any(|name| m.name.starts_with(name.as_str())))
    };
    let mutants: Vec<Mutant> = all(&root.join("tests/mutants"))?.into_iter().filter(wanted).collect();
    if mutants.is_empty() {
        return Err(format!("no mutant of tests/mutants begins like {arguments:?}"));
    }
    let mut tree = Tree::new(root)?;
    tree.check(&mutants)?;
    println!("| mutant | row | verdict |\n|---|---|---|");
    let (mut ran, mut survived) = (0, 0);
    for mutant in &mutants {
        let verdict = match &mutant.equivalent {
            Some(why) => format!("equivalent: {why}"),
            None => {
                ran += 1;
                tree.verdict(mutant)?.unwrap_or_else(|| {
                    survived += 1;
                    "**survived**".into()
                })
            }
        };
        println!("| {} | {} | {verdict} |", mutant.name, mutant.row);
    }
    println!("\n{ran} mutants, {survived} survived");
    Ok(survived)
}

/// A line `Test:`: the target of cargo, and what the names of its tests hold.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct Tests {
    target: &'static [&'static str],
    filter: String,
}

#[derive(Debug)]
struct Mutant {
    name: String,
    row: String,
    tests: Vec<Tests>,
    driver: Option<String>,
    equivalent: Option<String>,
    patch: PathBuf,
    /// The files that it changes.
    files: Vec<String>,
}

/// The mutants of a folder by name.
fn all(folder: &Path) -> Result<Vec<Mutant>, String> {
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "patch"));
    paths.sort();
    paths.into_iter().map(|path| Mutant::read(&path).ok_or(format!("{}: no such head", path.display()))).collect()
}

impl Mutant {
    fn read(path: &Path) -> Option<Self> {
        let text = fs::read_to_string(path).ok()?;
        let head: Vec<&str> = text.lines().take_while(|line| !line.starts_with("--- ")).collect();
        let fields = |name: &str| -> Vec<&str> {
            head.iter().filter_map(|line| line.strip_prefix(name)?.strip_prefix(": ")).collect()
        };
        let field = |name| fields(name).first().map(|value| (*value).to_owned());
        let tests = |line: &str| -> Option<Tests> {
            let (target, filter) = line.split_once(' ')?;
            let target: &[&str] = match target {
                "suite" => &["--test", "suite"],
                "lib" => &["--lib"],
                "demo" => &["--package", "deferred-aa-demo", "--lib"],
                _ => return None,
            };
            Some(Tests { target, filter: filter.to_owned() })
        };
        Some(Self {
            name: path.file_stem()?.to_str()?.to_owned(),
            row: field("Row")?,
            tests: fields("Test").into_iter().map(tests).collect::<Option<Vec<_>>>().filter(|t| !t.is_empty())?,
            driver: field("Driver"),
            equivalent: field("Equivalent"),
            patch: path.to_owned(),
            files: text.lines().filter_map(|line| line.strip_prefix("+++ b/")).map(str::to_owned).collect(),
        })
    }
}

/// A copy of the tree, and the executables of its tests as they are without a mutant.
struct Tree {
    root: PathBuf,
    copy: PathBuf,
    executables: HashMap<&'static [&'static str], PathBuf>,
}

impl Tree {
    fn new(root: &Path) -> Result<Self, String> {
        let copy = root.join("target/mutants/tree");
        if copy.exists() {
            fs::remove_dir_all(&copy).map_err(|e| format!("{}: {e}", copy.display()))?;
        }
        fs::create_dir_all(&copy).map_err(|e| format!("{}: {e}", copy.display()))?;
        // With their times, so that cargo builds anew only what has changed.
        let mut cp = Command::new("cp");
        cp.arg("-Rp").args(["Cargo.toml", "Cargo.lock", "README.md", "CHANGELOG.md"]);
        cp.args(["src", "shaders", "docs", "demo", "tests", "benches", "examples"]).arg(&copy).current_dir(root);
        done(&mut cp)?;
        Ok(Self { root: root.to_owned(), copy, executables: HashMap::new() })
    }

    /// Runs all tests without a mutant: what is red then shows nothing.
    fn check(&mut self, mutants: &[Mutant]) -> Result<(), String> {
        let mut seen: Vec<&Tests> = Vec::new();
        for tests in mutants.iter().filter(|m| m.equivalent.is_none()).flat_map(|m| &m.tests) {
            if seen.contains(&tests) {
                continue;
            }
            seen.push(tests);
            if !self.executables.contains_key(tests.target) {
                self.executables.insert(tests.target, self.build(tests.target, "whole")?);
            }
            eprintln!("mutants: without one: {}", tests.filter);
            let (code, said) = self.test(&self.executables[tests.target], tests)?;
            if code != Some(0) {
                return Err(format!("{} fails without a mutant:\n{said}", tests.filter));
            }
            if !said.lines().any(|line| line.starts_with("test ") && line.ends_with(" ok")) {
                return Err(format!("no test is named like {}", tests.filter));
            }
        }
        Ok(())
    }

    /// What the first test that notices says; `None` if all pass.
    fn verdict(&self, mutant: &Mutant) -> Result<Option<String>, String> {
        let before: Vec<Vec<u8>> = mutant.files.iter().map(|file| self.read(file)).collect::<Result<_, _>>()?;
        self.apply(&mutant.patch, &[]).map_err(|e| format!("{} no longer applies, write it anew: {e}", mutant.name))?;
        let found = self.first_red(mutant, &before);
        self.apply(&mutant.patch, &["-R"])?;
        found
    }

    fn first_red(&self, mutant: &Mutant, before: &[Vec<u8>]) -> Result<Option<String>, String> {
        for tests in &mutant.tests {
            let executable = if mutant.files.iter().all(|file| file.ends_with(".wgsl")) {
                self.rewritten(&self.executables[tests.target], mutant, before)?
            } else {
                self.build(tests.target, "mutant").map_err(|e| format!("{}: {e}", mutant.name))?
            };
            let (code, said) = self.test(&executable, tests)?;
            if code == Some(0) {
                continue;
            }
            let mut lines = said.lines().skip_while(|line| !line.contains("panicked at")).skip(1);
            let first: String = lines.next().unwrap_or(&said).chars().take(100).collect();
            // A shader that does not compile is no mutant.
            if said.contains("Shader validation error") || said.contains("parsing error") {
                return Err(format!("{} does not compile:\n{said}", mutant.name));
            }
            return Ok(Some(match code {
                Some(_) => format!("red: {}", first.replace('|', "\\|")),
                None => "red: it hangs".into(),
            }));
        }
        Ok(None)
    }

    fn read(&self, file: &str) -> Result<Vec<u8>, String> {
        fs::read(self.copy.join(file)).map_err(|e| format!("{file}: {e}"))
    }

    fn apply(&self, patch: &Path, arguments: &[&str]) -> Result<(), String> {
        let mut git = Command::new("git");
        git.arg("apply").args(arguments).arg(patch).current_dir(&self.copy);
        // Else git looks for the files of the tree around the copy.
        git.env("GIT_CEILING_DIRECTORIES", self.root.join("target/mutants"));
        done(&mut git).map(|_| ())
    }

    /// Builds the tests of a target in the copy; returns a copy of their executable, as other builds may write one of the
    /// same name.
    fn build(&self, target: &[&str], name: &str) -> Result<PathBuf, String> {
        let mut cargo = Command::new(env::var_os("CARGO").unwrap_or("cargo".into()));
        cargo.args(["test", "--locked", "--no-run"]).args(target).current_dir(&self.copy);
        cargo.env("CARGO_TARGET_DIR", self.root.join("target"));
        let said = done(&mut cargo)?;
        let said = String::from_utf8_lossy(&said.stderr).into_owned();
        let path = said.lines().filter_map(|line| line.trim().strip_prefix("Executable")?.rsplit_once('('));
        let path = path.last().map(|(_, path)| self.copy.join(path.trim_end_matches(')')));
        let path = path.ok_or(format!("cargo named no executable:\n{said}"))?;
        let kept = self.root.join("target/mutants").join(target.concat() + name);
        fs::copy(&path, &kept).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(kept)
    }

    /// A copy of the executable with the shaders of the mutant.
    fn rewritten(&self, executable: &Path, mutant: &Mutant, before: &[Vec<u8>]) -> Result<PathBuf, String> {
        let mut bytes = fs::read(executable).map_err(|e| format!("{}: {e}", executable.display()))?;
        for (file, before) in mutant.files.iter().zip(before) {
            let mut after = self.read(file)?;
            if after.len() > before.len() {
                let text = String::from_utf8_lossy(&after).into_owned();
                let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
                after = code.flat_map(|line| [line.as_bytes(), b"\n"].concat()).collect();
            }
            if after.len() > before.len() {
                return Err(format!("{}: {file} grows by more than its comments are long", mutant.name));
            }
            after.resize(before.len(), b'\n');
            let mut places = Vec::new();
            let mut from = 0;
            while let Some(at) = find(&bytes[from..], before) {
                places.push(from + at);
                from += at + before.len();
            }
            if places.is_empty() {
                return Err(format!("{file} is not in {}", executable.display()));
            }
            for at in places {
                bytes[at..at + after.len()].copy_from_slice(&after);
            }
        }
        let path = self.root.join("target/mutants/rewritten");
        fs::copy(executable, &path).and_then(|_| fs::write(&path, bytes)).map_err(|e| e.to_string())?;
        Ok(path)
    }

    /// Runs tests: their exit code, `None` where they hang, and what they said.
    fn test(&self, executable: &Path, tests: &Tests) -> Result<(Option<i32>, String), String> {
        let log = self.root.join("target/mutants/said");
        let file = fs::File::create(&log).map_err(|e| e.to_string())?;
        let folder =
            if tests.target.contains(&"deferred-aa-demo") { self.copy.join("demo") } else { self.copy.clone() };
        let mut child = Command::new(executable)
            .arg(&tests.filter)
            .current_dir(folder)
            .env("RUST_BACKTRACE", "0")
            .stdin(Stdio::null())
            .stdout(file.try_clone().map_err(|e| e.to_string())?)
            .stderr(file)
            .spawn()
            .map_err(|e| format!("{}: {e}", executable.display()))?;
        let start = Instant::now();
        let code = loop {
            if let Some(status) = child.try_wait().map_err(|e| e.to_string())? {
                // Killed by a signal is no hang.
                break Some(status.code().unwrap_or(-1));
            }
            if start.elapsed() > MOST {
                child.kill().and_then(|()| child.wait()).map_err(|e| e.to_string())?;
                break None;
            }
            thread::sleep(Duration::from_millis(20));
        };
        Ok((code, String::from_utf8_lossy(&fs::read(&log).unwrap_or_default()).into_owned()))
    }
}

/// Where a text begins in bytes.
fn find(bytes: &[u8], text: &[u8]) -> Option<usize> {
    // Almost every place is told by its first words.
    let head = &text[..text.len().min(16)];
    let mut from = 0;
    while let Some(at) = bytes[from..].windows(head.len()).position(|w| w == head) {
        if bytes[from + at..].starts_with(text) {
            return Some(from + at);
        }
        from += at + 1;
    }
    None
}

fn done(command: &mut Command) -> Result<Output, String> {
    let output = command.output().map_err(|e| format!("{command:?}: {e}"))?;
    if output.status.success() {
        return Ok(output);
    }
    Err(format!("{command:?}:\n{}", String::from_utf8_lossy(&output.stderr)))
}
