//! `cargo xtask book`: the page of the manual that the program writes about itself.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The program's description of its integrators, under one heading.
fn page(root: &Path, mut program: Command) -> Result<String, String> {
    let output = program
        .args(["integrators", "--markdown"])
        .current_dir(root)
        .output()
        .map_err(|e| format!("cannot start the program: {e}"))?;
    if !output.status.success() {
        return Err(format!("`tyndall integrators` failed\n{}", String::from_utf8_lossy(&output.stderr)));
    }
    let text = String::from_utf8(output.stdout).map_err(|e| format!("`tyndall integrators` wrote no UTF-8: {e}"))?;
    Ok(under_one_heading(&text))
}

fn under_one_heading(text: &str) -> String {
    let demoted =
        text.lines().map(|line| if line.starts_with('#') { format!("#{line}\n") } else { format!("{line}\n") });
    let head = "<!-- Written by `cargo xtask book`. -->\n\n# Integrators\n\nChosen by the scene, or by `tyndall render \
                --integrator NAME --set PARAMETER=VALUE`.\n\n";
    std::iter::once(head.to_string()).chain(demoted).collect()
}

fn file(root: &Path) -> PathBuf {
    root.join("docs/book/src/integrators.md")
}

/// Writes the page.
pub(crate) fn write(root: &Path) -> Result<(), String> {
    let file = file(root);
    let mut program = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    program.args(["run", "--quiet", "--release", "--package", "tyndall-cli", "--"]);
    std::fs::write(&file, page(root, program)?).map_err(|e| format!("cannot write {}: {e}", file.display()))
}

/// Checks that the page is current, by the program that the tests have built: `cargo run` would build the library once more, with
/// the features that it needs alone.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    let file = file(root);
    let this = std::env::current_exe().map_err(|e| format!("cannot find this program: {e}"))?;
    let target = this.ancestors().nth(2).ok_or("this program is not in a target folder")?;
    let program = Command::new(target.join("release").join(format!("tyndall{}", std::env::consts::EXE_SUFFIX)));
    let kept = std::fs::read_to_string(&file).map_err(|e| format!("cannot read {}: {e}", file.display()))?;
    if kept == page(root, program)? {
        Ok(())
    } else {
        Err(format!("{} is out of date: run cargo xtask book", file.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::under_one_heading;

    #[test]
    fn headings_sink_by_one() {
        let page = under_one_heading("# `a`\n\ntext # here\n");
        assert!(page.ends_with("\n\n## `a`\n\ntext # here\n"), "{page}");
        assert_eq!(page.lines().filter(|line| line.starts_with("# ")).count(), 1);
    }
}
