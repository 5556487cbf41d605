//! The command line: arguments, and one file for each subcommand. Each returns how it ended, so
//! that the binary does no more than hand its arguments over.

mod args;
mod bench;
mod check;
mod dump;
mod explain;
mod info;
mod new;
mod plan;
mod render;
mod report;
mod session;
mod table;
mod test;
mod view;
mod watch;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::Parser as _;

use crate::output;
pub use args::Cli;
pub use report::Exit;

/// Runs the program with its arguments, the first of which is its own name.
pub fn run(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(wrong) => {
            // Help and version are wanted, all else is wrong usage; a closed stream leaves nobody to tell.
            let exit = if wrong.use_stderr() { Exit::Usage } else { Exit::Done };
            _ = wrong.print();
            return exit.into();
        }
    };
    match &cli.command {
        args::Command::View(args) => view::run(args),
        args::Command::Render(args) => render::run(args),
        args::Command::Watch(args) => watch::run(args),
        args::Command::Check(args) => check::run(args),
        args::Command::Plan(args) => plan::run(args),
        args::Command::Bench(args) => bench::run(args),
        args::Command::Test(args) => test::run(args),
        args::Command::Info(args) => info::run(args),
        args::Command::Explain(args) => explain::run(args),
        args::Command::New(args) => new::run(args),
    }
    .into()
}
