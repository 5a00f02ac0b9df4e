//! Mitsuba scene files, versions 0.5 to 3.x.
//!
//! What a file means is what Mitsuba 3 makes of it in its RGB variants. Where older files used words that Mitsuba 3 no
//! longer reads, such as `sigmaS`, the reader translates them.

mod assets;
mod bsdfs;
mod cie;
mod emitters;
mod film;
mod integrators;
mod media;
mod metals;
mod numbers;
mod phases;
mod properties;
mod sensors;
mod shapes;
mod source;
mod spectra;
mod substitute;
mod textures;
mod upgrade;
mod volumes;
mod xml;

pub use integrators::IntegratorSource;
pub use source::{SceneError, Warning};

use assets::Assets;
use properties::Bag;
use source::Place;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use tyndall::scene::desc::{BsdfId, MediumId, SceneDesc, ShapeGroupId};
use xml::{Attribute, Node, Tree};

/// How deep objects may refer to objects.
const DEEPEST: usize = 64;
/// How often objects may be read again because something else refers to them.
const MOST_REPEATS: usize = 1 << 18;

/// What the caller says about a scene.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Values for `$name`, which win over `<default>`.
    pub defines: Vec<(String, String)>,
}

/// A scene that was read.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: SceneDesc,
    /// Where its integrator is written.
    pub integrator: IntegratorSource,
    /// What its author may want to know.
    pub warnings: Vec<Warning>,
}

/// Reads a scene file and every file it needs.
pub fn read(path: &Path, options: &Options) -> Result<Loaded, SceneError> {
    let name = path.display().to_string();
    let bytes = crate::file::read_bytes(path).map_err(|e| SceneError::unreadable(&name, e.message))?;
    let text = String::from_utf8(bytes)
        .map_err(|e| SceneError::unreadable(&name, format!("byte {} is not UTF-8", e.utf8_error().valid_up_to())))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let tree = xml::load(&text, &name, Some(path), folder, &options.defines)?;
    Reader::new(&tree).scene()
}

/// Reads a scene from its text; file names in it are relative to `folder`.
pub fn read_str(text: &str, folder: &Path, options: &Options) -> Result<Loaded, SceneError> {
    let tree = xml::load(text, "<text>", None, folder, &options.defines)?;
    Reader::new(&tree).scene()
}

/// What has been read so far.
struct Reader<'t> {
    tree: &'t Tree,
    ids: HashMap<&'t str, &'t Node>,
    scene: SceneDesc,
    warnings: Vec<Warning>,
    assets: Assets,
    bsdfs: HashMap<usize, BsdfId>,
    media: HashMap<usize, MediumId>,
    groups: HashMap<usize, ShapeGroupId>,
    /// Objects being read, outermost first.
    open: Vec<usize>,
    seen: HashSet<usize>,
    repeats: usize,
}

impl<'t> Reader<'t> {
    fn new(tree: &'t Tree) -> Self {
        Self {
            tree,
            ids: tree.ids(),
            scene: SceneDesc::default(),
            warnings: Vec::new(),
            assets: Assets::default(),
            bsdfs: HashMap::new(),
            media: HashMap::new(),
            groups: HashMap::new(),
            open: Vec::new(),
            seen: HashSet::new(),
            repeats: 0,
        }
    }

    fn scene(mut self) -> Result<Loaded, SceneError> {
        let bag = self.open(&self.tree.root)?;
        let mut integrator = IntegratorSource::none(bag.place());
        if let Some(node) = bag.child("integrator")? {
            (self.scene.integrator, integrator) = self.integrator(node)?;
        }
        self.sensors(&bag)?;
        for (_, node) in bag.children("bsdf") {
            self.bsdf(node)?;
        }
        for (_, node) in bag.children("medium") {
            self.medium(node)?;
        }
        for (_, node) in bag.children("texture") {
            self.texture_plugin(node, textures::Quantity::Unbounded)?;
        }
        for (_, node) in bag.children("volume") {
            self.volume_plugin(node)?;
        }
        for (_, node) in bag.children("phase") {
            self.phase(node)?;
        }
        for (_, node) in bag.children("emitter") {
            let emitter = self.emitter(node)?;
            self.scene.emitters.push(emitter);
        }
        for (property, node) in bag.children("shape") {
            self.top_shape(property, node)?;
        }
        // These stand alone only to be referred to.
        for family in ["film", "sampler", "rfilter"] {
            bag.children(family);
        }
        self.close(&bag)?;
        Ok(Loaded { scene: self.scene, integrator, warnings: self.warnings })
    }

    /// Begins to read an object.
    fn open(&mut self, node: &'t Node) -> Result<Bag<'t>, SceneError> {
        let name = || node.attribute("id").map_or_else(|| node.tag.clone(), |id| format!("\"{}\"", id.value));
        if self.open.contains(&node.index) {
            return Err(node.place.error(format!("{} refers to itself, expected no cycle", name())));
        }
        if self.open.len() >= DEEPEST {
            return Err(node
                .place
                .error(format!("{} is nested more than {DEEPEST} deep, expected fewer levels", name())));
        }
        if !self.seen.insert(node.index) {
            self.repeats += 1;
            if self.repeats > MOST_REPEATS {
                return Err(node.place.error(format!("{} is referred to more than {MOST_REPEATS} times", name())));
            }
        }
        self.open.push(node.index);
        Bag::open(node, &self.ids)
    }

    /// Ends it: everything must have been understood.
    fn close(&mut self, bag: &Bag) -> Result<(), SceneError> {
        self.open.pop();
        bag.close()
    }

    fn warn(&mut self, place: &Place, message: impl Into<String>) {
        self.warnings.push(place.warning(message));
    }

    /// The file that an attribute names.
    fn file(&self, filename: &Attribute) -> Result<PathBuf, SceneError> {
        xml::find(&self.tree.folders, &filename.value).ok_or_else(|| xml::not_found(&self.tree.folders, filename))
    }
}
