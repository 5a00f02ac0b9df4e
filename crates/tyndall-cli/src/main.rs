//! The program `tyndall`.

mod args;
mod check;
mod checkpoint;
mod choice;
mod compare;
mod console;
mod failure;
mod fingerprint;
mod image;
mod integrators;
mod interrupt;
mod leash;
mod load;
mod output;
mod progress;
mod pyramid;
mod render;
mod series;
mod state;
mod statistics;
mod view;

use args::{Cli, Command};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let done = |()| ExitCode::SUCCESS;
    let result = match Cli::parse().command {
        Command::Render(args) => render::run(&args),
        Command::Check(args) => check::run(&args).map(done),
        Command::Integrators(args) => integrators::run(&args).map(done),
        Command::Compare(args) => compare::run(&args),
        Command::View(args) => view::run(&args).map(done),
        Command::Leash { command } => leash::run(&command),
        Command::Image(args) => image::run(&args).map(done),
    };
    result.unwrap_or_else(failure::Failure::report)
}
