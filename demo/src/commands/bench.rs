//! `bench`: the standing figures of this machine, in one file to send.

use super::args::{frames, parse_size};
use super::error::{CommandError, wrong};
use super::output::{say, write_json};
use crate::bench::{self, Bench as Figures, Plan};
use crate::host::gpu;
use std::path::PathBuf;

/// See `deferred-aa-demo bench --help`.
#[derive(Debug, clap::Args)]
pub struct Bench {
    /// About how long it may take; what does not fit is left out, and said to be.
    #[arg(long, default_value_t = 5.0)]
    minutes: f64,
    /// Pixels, WIDTHxHEIGHT; 1920x1080 if not given, or 240x135 where a CPU stands in for a GPU.
    #[arg(long, value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// The most measured frames of each entry, after one that warms up; fewer if time is short. Those of a scene are interleaved.
    #[arg(long, default_value_t = 15, value_parser = frames())]
    frames: u32,
    /// Part of the adapter's name; `adapters` lists them.
    #[arg(long)]
    adapter: Option<String>,
    /// The file for all figures. An earlier bench.json is replaced, another file is not.
    #[arg(long, default_value = "bench.json")]
    out: PathBuf,
}

/// Of the pictures where pixels are shaded by a CPU.
const ON_A_CPU: (u32, u32) = (240, 135);

impl Bench {
    pub fn run(self) -> Result<(), CommandError> {
        if !(self.minutes > 0.0 && self.minutes <= 1e4) {
            return Err(wrong("--minutes", format!("{} is not a time: more than 0", self.minutes)));
        }
        self.check_out()?;
        let adapter = gpu::choose(self.adapter.as_deref())?;
        let on_a_cpu = adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let size = self.size.unwrap_or(if on_a_cpu { ON_A_CPU } else { (1920, 1080) });
        let plan = Plan::standing(size, self.frames);
        let count = plan.cells.len();
        let mut written = Ok(());
        let figures = bench::run(
            &adapter,
            &plan,
            self.minutes,
            |i, cell| eprintln!("{} of {count}: {}", i + 1, cell.name()),
            |figures| {
                if figures.measured.len() == 1 {
                    say(&bench::heading(figures));
                }
                say(bench::table(figures).trim_end());
                // After each, so that a stop loses nothing.
                written = write_json(&self.out, figures);
            },
        );
        written?;
        write_json(&self.out, &figures)?;
        say(&format!("{}{:.0} seconds; {}", bench::ratios(&figures), figures.seconds, self.out.display()));
        if figures.measured.is_empty() {
            let why = figures.left_out.first().map_or("nothing to measure", |left| &left.why);
            return Err(wrong("bench", format!("nothing could be measured: {why}")));
        }
        Ok(())
    }

    /// Before minutes are spent: a place that can be written to, and nothing there that is somebody's.
    fn check_out(&self) -> Result<(), CommandError> {
        let path = self.out.display();
        let taken = || wrong("--out", format!("{path} is there and is no bench.json: name another file"));
        match std::fs::read(&self.out) {
            Ok(bytes) => serde_json::from_slice::<Figures>(&bytes).map(|_| ()).map_err(|_| taken()),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
                let folder = self.out.parent().filter(|folder| !folder.as_os_str().is_empty());
                folder
                    .map_or(Ok(()), std::fs::create_dir_all)
                    .map_err(|e| wrong("--out", format!("{path}: {e}; name a file in a folder that can be made")))
            }
            Err(e) => Err(wrong("--out", format!("{path}: {e}; name a file"))),
        }
    }
}
