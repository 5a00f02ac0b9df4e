//! Tasks that need Mitsuba 3: they run the scripts in xtask/python with a Python that has it.

use crate::ci::step;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the reference images and the races are made with.
const PACKAGES: [&str; 2] = ["mitsuba==3.9.1", "numpy"];

/// The Python named by `TYNDALL_PYTHON`, or a virtual environment in target/mitsuba, made if it is not there.
fn interpreter(root: &Path) -> Result<PathBuf, String> {
    if let Some(given) = std::env::var_os("TYNDALL_PYTHON") {
        return Ok(given.into());
    }
    let home = root.join("target/mitsuba");
    let python = home.join("bin/python");
    if !home.join("complete").exists() {
        step(root, Command::new("python3").args(["-m", "venv"]).arg(&home))?;
        step(root, Command::new(&python).args(["-m", "pip", "install", "--quiet"]).args(PACKAGES)).map_err(|e| {
            format!(
                "Mitsuba 3 cannot be installed from PyPI: {e}\nset TYNDALL_PYTHON to a Python that has {PACKAGES:?}"
            )
        })?;
        std::fs::write(home.join("complete"), "").map_err(|e| format!("cannot write to {}: {e}", home.display()))?;
    }
    Ok(python)
}

fn script(root: &Path, name: &str) -> Result<Command, String> {
    let mut command = Command::new(interpreter(root)?);
    command.arg(root.join("xtask/python").join(name));
    Ok(command)
}

/// Renders the references of crates/tyndall-formats/tests/references.
pub(crate) fn references(root: &Path, only: Option<&str>) -> Result<(), String> {
    let mut command = script(root, "references.py")?;
    command.arg(root.join("crates/tyndall-formats/tests/references"));
    step(root, command.args(only))
}

/// Runs the races on scenes/peers.
pub(crate) fn peers(root: &Path, only: Option<&str>, threads: u32, size: u32, integrators: &str) -> Result<(), String> {
    crate::scenes::peers(root).map_err(|e| format!("cannot write the grid of the peers' smoke: {e}"))?;
    step(root, Command::new("cargo").args(["build", "--quiet", "--release", "--package", "tyndall-cli"]))?;
    let mut command = script(root, "peers.py")?;
    command.args(["--scenes"]).arg(root.join("scenes/peers"));
    command.args(["--tyndall"]).arg(root.join("target/release/tyndall"));
    command.args(["--cache"]).arg(root.join("target/peers"));
    command.args(["--threads", &threads.to_string(), "--size", &size.to_string()]);
    command.args(["--integrators", integrators]);
    step(root, command.args(only))
}
