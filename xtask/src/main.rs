//! Developer tasks: what a person would otherwise do by hand.

mod book;
mod ci;
mod layers;
mod python;
mod scenes;

use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Developer tasks of Tyndall.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Everything a change must pass: format, lints, layers, tests, documentation, manual, fuzz targets.
    Ci,
    /// Check that no room of the library uses one above it.
    Layers,
    /// Write the manual's page of integrators.
    Book,
    /// Write the side files of the scenes: grids and meshes.
    Scenes,
    /// Render the reference images of the format tests with Mitsuba 3 (from PyPI, in target/mitsuba).
    References {
        /// Only the scenes whose name contains this.
        only: Option<String>,
    },
    /// Race Mitsuba 3 on the peer scenes: speed, error at equal samples, time to equal error.
    Peers {
        /// Only the scenes whose name contains this.
        only: Option<String>,
        /// Threads of every renderer.
        #[arg(long, default_value_t = 2)]
        threads: u32,
        /// Width and height of the images.
        #[arg(long, default_value_t = 256)]
        size: u32,
        /// Integrators of Tyndall that run to Mitsuba's error.
        #[arg(long, default_value = "volpath,pbre")]
        integrators: String,
    },
}

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the root").to_path_buf()
}

fn main() -> ExitCode {
    let root = root();
    let result = match Arguments::parse().task {
        Task::Ci => ci::run(&root),
        Task::Layers => layers::check(&root),
        Task::Book => book::write(&root),
        Task::Scenes => scenes::write(&root).map_err(|e| format!("cannot write the scenes: {e}")),
        Task::References { only } => python::references(&root, only.as_deref()),
        Task::Peers { only, threads, size, integrators } => {
            python::peers(&root, only.as_deref(), threads, size, &integrators)
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}
