//! `cargo xtask ci`: one step after the other, stopping at the first that fails.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

/// Runs a command in `root`, saying so first.
pub(crate) fn step(root: &Path, command: &mut Command) -> Result<(), String> {
    let words: Vec<_> =
        [command.get_program()].into_iter().chain(command.get_args()).map(|w| w.to_string_lossy()).collect();
    let line = words.join(" ");
    println!("==> {line}");
    let start = Instant::now();
    let status = command.current_dir(root).status().map_err(|e| format!("cannot start `{line}`: {e}"))?;
    if !status.success() {
        return Err(format!("`{line}` failed ({status})"));
    }
    println!("    {:.1} s", start.elapsed().as_secs_f64());
    Ok(())
}

fn cargo(arguments: &str) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments.split_whitespace());
    command
}

/// Installs what the browser test drives where it is missing and can be installed so; the test says when it was skipped.
fn browser() {
    let starts = |program: &str, argument: &str| {
        let mut command = Command::new(program);
        command.arg(argument).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    };
    if starts("chromedriver", "--version") {
        return;
    }
    println!("==> a Chromium for the browser test");
    let install = |words: &[&str]| {
        let mut command = Command::new("apt-get");
        command.args(words).env("DEBIAN_FRONTEND", "noninteractive");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    };
    let done = install(&["update"]) && install(&["install", "--yes", "chromium", "chromium-driver"]);
    println!("    {}", if done { "installed" } else { "could not be installed: the browser test will be skipped" });
}

/// Everything a change must pass.
pub(crate) fn run(root: &Path) -> Result<(), String> {
    step(root, &mut cargo("fmt --all --check"))?;
    println!("==> layers");
    crate::layers::check(root)?;
    step(root, &mut cargo("clippy --release --workspace --all-targets -- -D warnings"))?;
    browser();
    step(root, &mut cargo("test --release --workspace"))?;
    step(
        root,
        cargo("doc --release --workspace --no-deps --document-private-items").env("RUSTDOCFLAGS", "-D warnings"),
    )?;
    println!("==> book");
    crate::book::check(root)?;
    if root.join("fuzz/Cargo.toml").exists() {
        // With the profile of the steps before, so that most of the libraries they have checked serve here too.
        let same = "--release --target-dir target --config profile.release.debug-assertions=false \
                    --config profile.release.overflow-checks=false";
        step(root, &mut cargo(&format!("check --manifest-path fuzz/Cargo.toml {same}")))?;
    }
    println!("all passed");
    Ok(())
}
