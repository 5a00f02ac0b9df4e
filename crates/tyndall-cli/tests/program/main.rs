//! The program as its users meet it: run as a process on small scenes.

mod check;
mod checkpoints;
mod compare;
mod errors;
mod images;
mod photons;
mod pyramid;
mod render;

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tyndall_formats::image::{Picture, read_picture};

/// A foggy ball over a floor: 20 x 14 pixels, 4 samples.
pub const SCENE: &str = r#"<scene version="3.0.0">
    <default name="albedo" value="0.8"/>
    <integrator type="volpath"><integer name="max_depth" value="6"/></integrator>
    <sensor type="perspective">
        <float name="fov" value="40"/>
        <transform name="to_world"><lookat origin="0, 1, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="20"/><integer name="height" value="14"/></film>
        <sampler type="independent"><integer name="sample_count" value="4"/></sampler>
    </sensor>
    <medium type="homogeneous" id="fog">
        <float name="sigma_t" value="1.5"/>
        <float name="albedo" value="$albedo"/>
        <phase type="hg"><float name="g" value="0.3"/></phase>
    </medium>
    <shape type="sphere"><bsdf type="null"/><ref name="interior" id="fog"/></shape>
    <shape type="rectangle">
        <transform name="to_world">
            <rotate x="1" angle="-90"/><scale value="3"/><translate y="-1"/>
        </transform>
        <bsdf type="diffuse"/>
    </shape>
    <emitter type="point"><point name="position" x="2" y="3" z="2"/><rgb name="intensity" value="9, 8, 7"/></emitter>
    <emitter type="constant"><rgb name="radiance" value="0.3"/></emitter>
</scene>
"#;

/// A folder with the scene in it, in which the program runs.
pub struct Folder(tempfile::TempDir);

impl Folder {
    /// With nothing but the scene in it.
    pub fn with_scene() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        std::fs::write(folder.path("ball.xml"), SCENE).unwrap();
        folder
    }

    /// A file in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The program with words as its arguments.
    pub fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tyndall"));
        command.current_dir(self.0.path()).args(words.split_whitespace()).stdin(Stdio::null());
        command
    }

    /// Runs the program to its end.
    pub fn run(&self, words: &str) -> Output {
        self.command(words).output().unwrap()
    }

    /// Runs what must succeed; what it says on the output and on the error stream.
    pub fn succeed(&self, words: &str) -> (String, String) {
        let output = self.run(words);
        let (out, err) = (text(&output.stdout), text(&output.stderr));
        assert!(output.status.success(), "{words}\n{out}\n{err}");
        (out, err)
    }

    /// Runs what must fail with `code`; what it says.
    pub fn fail(&self, words: &str, code: i32) -> String {
        let output = self.run(words);
        let err = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{words}\n{err}");
        assert!(err.contains("error: ") && !err.contains("panicked"), "{words}\n{err}");
        err
    }

    /// Reads a picture.
    pub fn picture(&self, name: &str) -> Picture {
        read_picture(&self.path(name)).unwrap()
    }

    /// A picture without the one thing that differs between equal renders.
    pub fn timeless(&self, name: &str) -> Picture {
        let mut picture = self.picture(name);
        picture.attributes.retain(|(name, _)| name != "seconds");
        picture
    }

    /// Names of all files.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

/// What was said.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The red channel of the main layer.
pub fn red(picture: &Picture) -> &[f32] {
    picture.layer("").unwrap().channel("R").unwrap()
}

/// A file's first bytes.
pub fn magic(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap()[..4].to_vec()
}
