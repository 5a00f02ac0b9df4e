//! `cargo xtask ci`: one step after the other, stopping at the first that fails.

use std::path::Path;
use std::process::Command;
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

/// Everything a change must pass.
pub(crate) fn run(root: &Path) -> Result<(), String> {
    step(root, &mut cargo("fmt --all --check"))?;
    println!("==> layers");
    crate::layers::check(root)?;
    step(root, &mut cargo("clippy --release --workspace --all-targets -- -D warnings"))?;
    step(root, &mut cargo("test --release --workspace"))?;
    step(
        root,
        cargo("doc --release --workspace --no-deps --document-private-items").env("RUSTDOCFLAGS", "-D warnings"),
    )?;
    println!("==> book");
    crate::book::check(root)?;
    if root.join("fuzz/Cargo.toml").exists() {
        step(root, &mut cargo("check --manifest-path fuzz/Cargo.toml"))?;
    }
    println!("all passed");
    Ok(())
}
