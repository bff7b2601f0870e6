//! The commands of `deferred-aa-demo`. Bad input ends with one line and exit code 2.

use clap::Parser;
use clap::error::ErrorKind;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = match deferred_aa_demo::commands::Cli::try_parse() {
        Ok(cli) => cli,
        // Without a command: all of them.
        Err(e) if e.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            eprint!("{e}");
            return ExitCode::from(2);
        }
        Err(e) if e.use_stderr() => {
            // clap's message spans lines: its first paragraph says what is wrong.
            let text = e.to_string();
            let first: Vec<_> = text.lines().map(str::trim).take_while(|l| !l.is_empty()).collect();
            eprintln!("{}; see --help", first.join(" "));
            return ExitCode::from(2);
        }
        Err(e) => {
            // Help or version.
            print!("{e}");
            return ExitCode::SUCCESS;
        }
    };
    match cli.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::from(2)
        }
    }
}
