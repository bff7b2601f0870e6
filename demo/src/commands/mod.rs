//! The command line.

mod adapters;
mod args;
mod bench;
mod demo;
mod error;
mod output;
mod render;
mod report;
mod set;
mod shaders;
mod tune;
mod view;

pub use error::CommandError;

/// Adaptive supersampling of deferred scenes: renders, measures, compares.
#[derive(Debug, clap::Parser)]
#[command(name = "deferred-aa-demo", version)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// Renders a scene by one technique: image.png, image.exr, samples.png and stats.json.
    Render(render::Render),
    /// Renders a scene without anti-aliasing, by FXAA, SMAA, Windowed, Surfaces and Full, draws comparison strips and
    /// prints a table.
    Demo(demo::Demo),
    /// Measures techniques over their settings against the truth: report.html, report.json, and pictures of every
    /// entry.
    Report(report::Report),
    /// Measures the standing figures of this machine within minutes, on built-in scenes: a table, and bench.json to
    /// send.
    Bench(bench::Bench),
    /// Searches the settings of a technique for presets that reach given errors with the fewest samples on several
    /// scenes.
    Tune(tune::Tune),
    /// Opens a window: every setting on a control, two of them side by side, what each costs and how near it comes,
    /// live.
    View(view::View),
    /// Writes the shaders of a technique in another language, with a table of what they bind: for engines that aren't
    /// on wgpu.
    Shaders(shaders::Shaders),
    /// Lists the graphics adapters and what each can run.
    Adapters,
}

impl Cli {
    /// Runs the command.
    pub fn run(self) -> Result<(), CommandError> {
        match self.command {
            Command::Render(render) => render.run(),
            Command::Demo(demo) => demo.run(),
            Command::Report(report) => report.run(),
            Command::Bench(bench) => bench.run(),
            Command::Tune(tune) => tune.run(),
            Command::View(view) => view.run(),
            Command::Shaders(shaders) => shaders.run(),
            Command::Adapters => {
                adapters::run();
                Ok(())
            }
        }
    }
}
