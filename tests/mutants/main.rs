//! `./x mutants [--driver NAME] [NAMES]`: breaks the project in one way after another, and runs the tests that must
//! notice.
//!
//! A mutant is a patch in this folder. The lines above it say what it breaks and what must go red:
//!
//! ```text
//! Row: the hard case
//! Test: suite numerics::limits::row_19   the tests of tests/suite whose name holds that; `lib` and `demo` for the unit
//!                                        tests of the library and of the demo; one of several lines must go red
//! Driver: swiftshader                    run by `./x mutants --driver swiftshader` alone
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
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(e) => {
            eprintln!("mutants: {e}");
            ExitCode::from(2)
        }
    }
}

/// What became of a mutant.
#[derive(Debug)]
enum Verdict {
    /// What the first test said that noticed.
    Red(String),
    Survived,
    /// What the tests say that they lack, as the driver has not got it.
    Skipped(String),
    /// Why nothing can notice it.
    Equivalent(String),
    /// It is not applied or not built.
    Broken(String),
}

/// Whether every mutant was red.
fn run() -> Result<bool, String> {
    let mut arguments: Vec<String> = env::args().skip(1).collect();
    let mut driver = None;
    if arguments.first().is_some_and(|a| a == "--driver") {
        driver = arguments.drain(..2.min(arguments.len())).nth(1);
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let of_driver = |m: &Mutant| m.driver == driver;
    let mut mutants: Vec<Mutant> = all(&root.join("tests/mutants"))?.into_iter().filter(of_driver).collect();
    let begins = |m: &Mutant, name: &String| m.name.starts_with(name.as_str());
    if let Some(name) = arguments.iter().find(|name| !mutants.iter().any(|m| begins(m, name))) {
        let driver = driver.as_deref().unwrap_or("any driver");
        return Err(format!("no mutant for {driver} begins like '{name}'"));
    }
    mutants.retain(|m| arguments.is_empty() || arguments.iter().any(|name| begins(m, name)));
    let mut tree = Tree::new(root)?;
    tree.check(&mutants)?;
    println!("| mutant | row | verdict |\n|---|---|---|");
    let mut counts = [0; 5];
    for mutant in &mutants {
        let (kind, said) = match tree.verdict(mutant)? {
            Verdict::Red(said) => (0, format!("red: {said}")),
            Verdict::Survived => (1, "**survived**".into()),
            Verdict::Skipped(lacks) => (2, format!("not run: {lacks}")),
            Verdict::Equivalent(why) => (3, format!("equivalent: {why}")),
            Verdict::Broken(e) => {
                eprintln!("mutants: {}: {e}", mutant.name);
                (4, "**broken**, see above".into())
            }
        };
        counts[kind] += 1;
        println!("| {} | {} | {} |", mutant.name, mutant.row, said.replace(['|', '\n'], " "));
    }
    let [red, survived, skipped, equivalent, broken] = counts;
    println!("\n{red} red, {survived} survived, {skipped} not run, {equivalent} equivalent, {broken} broken");
    Ok(survived + broken == 0)
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
        // With new times, or cargo might take what it built of the last mutant for this.
        let mut cp = Command::new("cp");
        cp.arg("-R").args(["Cargo.toml", "Cargo.lock", "README.md", "CHANGELOG.md"]);
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

    fn verdict(&self, mutant: &Mutant) -> Result<Verdict, String> {
        let before: Vec<Vec<u8>> = mutant.files.iter().map(|file| self.read(file)).collect::<Result<_, _>>()?;
        if let Err(e) = self.apply(&mutant.patch, &[]) {
            return Ok(Verdict::Broken(format!("it no longer applies, write it anew: {e}")));
        }
        let found = match &mutant.equivalent {
            Some(why) => Verdict::Equivalent(why.clone()),
            None => self.first_red(mutant, &before).unwrap_or_else(Verdict::Broken),
        };
        self.apply(&mutant.patch, &["-R"])?;
        Ok(found)
    }

    fn first_red(&self, mutant: &Mutant, before: &[Vec<u8>]) -> Result<Verdict, String> {
        let mut lacks = None;
        for tests in &mutant.tests {
            let executable = if mutant.files.iter().all(|file| file.ends_with(".wgsl")) {
                self.rewritten(&self.executables[tests.target], mutant, before)?
            } else {
                self.build(tests.target, "mutant")?
            };
            let (code, said) = self.test(&executable, tests)?;
            // A shader that does not compile is no mutant.
            if ["Shader validation error", "parsing error", "ends inside"].iter().any(|e| said.contains(e)) {
                return Err(format!("it does not compile:\n{said}"));
            }
            let mut lines = said.lines().skip_while(|line| !line.contains("panicked at")).skip(1);
            let mut first = || lines.next().map(|line| line.chars().take(100).collect::<String>());
            match code {
                Some(0) => lacks = lacks.or(said.lines().find(|line| line.contains("skipped")).map(str::to_owned)),
                // 101 is the code of tests that failed.
                Some(101) => return first().map(Verdict::Red).ok_or(format!("no test says why it failed:\n{said}")),
                Some(code) => return Ok(Verdict::Red(format!("the process ends with {code}"))),
                None => return Ok(Verdict::Red("it hangs".into())),
            }
        }
        Ok(lacks.map_or(Verdict::Survived, Verdict::Skipped))
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
        // The dependencies are those of the tree, but cargo must not take a mutant for the tree itself: it tells them by
        // their profile, not by where they lie.
        cargo.env("CARGO_TARGET_DIR", self.root.join("target")).env("CARGO_PROFILE_DEV_DEBUG", "0");
        cargo.env("CARGO_TERM_COLOR", "never").env("CARGO_TERM_QUIET", "false");
        let said = done(&mut cargo)?;
        let said = String::from_utf8_lossy(&said.stderr).into_owned();
        let path = said.lines().filter_map(|line| line.trim().strip_prefix("Executable")?.rsplit_once('('));
        let path = path.last().map(|(_, path)| self.copy.join(path.trim_end_matches(')')));
        let path = path.ok_or(format!("cargo named no executable:\n{said}"))?;
        let target = target.concat().replace('-', "");
        let kept = self.root.join("target/mutants").join(format!("{name}-{target}"));
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
            .args([tests.filter.as_str(), "--show-output"])
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
