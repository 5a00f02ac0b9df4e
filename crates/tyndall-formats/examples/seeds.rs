//! Writes the files that fuzzing starts from into `fuzz/corpus/TARGET/`.

#[path = "../tests/seeds/mod.rs"]
mod seeds;

fn main() -> std::io::Result<()> {
    let corpus = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    for (number, (format, bytes)) in seeds::all().into_iter().enumerate() {
        let folder = corpus.join(format);
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join(format!("seed-{number:02}")), bytes)?;
    }
    Ok(())
}
