//! Writes the corpus into a folder, with its answers in `answers.txt`, so that any renderer can be asked.

use std::fmt::Write;
use std::path::PathBuf;

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).expect("usage: corpus FOLDER"));
    std::fs::create_dir_all(&folder)?;
    let mut answers = String::new();
    for case in tyndall_testkit::corpus::all() {
        std::fs::write(folder.join(format!("{}.xml", case.name)), &case.xml)?;
        for (name, bytes) in &case.files {
            std::fs::write(folder.join(name), bytes)?;
        }
        let [r, g, b] = case.radiance;
        writeln!(answers, "{} {r:.6e} {g:.6e} {b:.6e} {:.1e}", case.name, case.error).expect("memory");
    }
    std::fs::write(folder.join("answers.txt"), answers)
}
