//! XML text to one tree: substitution, includes, search paths and aliases are done here.

use super::source::{Place, SceneError, Source, advise, nearest};
use super::substitute::Definitions;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Elements deeper than this are an attack or an accident.
const DEEPEST: usize = 64;

/// More included files than this are an attack or an accident: each may include the next one twice.
const MOST_INCLUDES: usize = 10_000;

/// Every element, and the attributes it may have.
const ELEMENTS: &[(&str, &[&str])] = &[
    ("scene", &["version", "type", "id", "name"]),
    ("bsdf", &["type", "id", "name", "version"]),
    ("emitter", &["type", "id", "name", "version"]),
    ("film", &["type", "id", "name", "version"]),
    ("integrator", &["type", "id", "name", "version"]),
    ("medium", &["type", "id", "name", "version"]),
    ("phase", &["type", "id", "name", "version"]),
    ("rfilter", &["type", "id", "name", "version"]),
    ("sampler", &["type", "id", "name", "version"]),
    ("sensor", &["type", "id", "name", "version"]),
    ("shape", &["type", "id", "name", "version"]),
    ("texture", &["type", "id", "name", "version"]),
    ("volume", &["type", "id", "name", "version"]),
    ("spectrum", &["type", "id", "name", "value", "filename", "intent", "version"]),
    ("float", &["name", "value"]),
    ("integer", &["name", "value"]),
    ("boolean", &["name", "value"]),
    ("string", &["name", "value"]),
    ("point", &["name", "value", "x", "y", "z"]),
    ("vector", &["name", "value", "x", "y", "z"]),
    ("rgb", &["name", "value", "intent"]),
    ("srgb", &["name", "value", "intent"]),
    ("blackbody", &["name", "temperature", "scale"]),
    ("transform", &["name"]),
    ("translate", &["value", "x", "y", "z"]),
    ("scale", &["value", "x", "y", "z"]),
    ("rotate", &["value", "x", "y", "z", "angle"]),
    ("lookat", &["origin", "target", "up"]),
    ("lookAt", &["origin", "target", "up"]),
    ("matrix", &["value"]),
    ("ref", &["id", "name"]),
    ("alias", &["id", "as"]),
    ("default", &["name", "value"]),
    ("include", &["filename"]),
    ("path", &["value"]),
];

/// Elements that stand for a plugin.
pub(crate) const OBJECTS: &[&str] = &[
    "scene",
    "bsdf",
    "emitter",
    "film",
    "integrator",
    "medium",
    "phase",
    "rfilter",
    "sampler",
    "sensor",
    "shape",
    "texture",
    "volume",
];

/// An attribute after substitution.
#[derive(Debug)]
pub(crate) struct Attribute {
    pub(crate) name: String,
    pub(crate) value: String,
    pub(crate) place: Place,
}

/// An element after substitution and inclusion.
#[derive(Debug)]
pub(crate) struct Node {
    /// Different for every element of a tree.
    pub(crate) index: usize,
    pub(crate) tag: String,
    /// The opening `<tag`.
    pub(crate) place: Place,
    pub(crate) attributes: Vec<Attribute>,
    pub(crate) children: Vec<Node>,
    /// Written for a version before 2: names are in camel case.
    pub(crate) old: bool,
}

impl Node {
    pub(crate) fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.name == name)
    }

    pub(crate) fn required(&self, name: &str) -> Result<&Attribute, SceneError> {
        self.attribute(name)
            .ok_or_else(|| self.place.error(format!("<{}> without \"{name}\", expected the attribute", self.tag)))
    }

    /// Whether the element stands for a plugin.
    pub(crate) fn is_object(&self) -> bool {
        OBJECTS.contains(&self.tag.as_str()) || (self.tag == "spectrum" && self.attribute("type").is_some())
    }

    /// The kind of object: spectra count as textures.
    pub(crate) fn family(&self) -> &str {
        if self.tag == "spectrum" { "texture" } else { &self.tag }
    }
}

/// A whole scene as elements.
#[derive(Debug)]
pub(crate) struct Tree {
    pub(crate) root: Node,
    /// Alias to id.
    aliases: HashMap<String, String>,
    /// Folders in which files are looked for, first one first.
    pub(crate) folders: Vec<PathBuf>,
}

impl Tree {
    /// All elements with an id, aliases included.
    pub(crate) fn ids(&self) -> HashMap<&str, &Node> {
        fn visit<'t>(node: &'t Node, ids: &mut HashMap<&'t str, &'t Node>) {
            if let Some(id) = node.attribute("id").filter(|_| node.is_object()) {
                ids.insert(&id.value, node);
            }
            node.children.iter().for_each(|child| visit(child, ids));
        }
        let mut ids = HashMap::new();
        visit(&self.root, &mut ids);
        for (alias, id) in &self.aliases {
            if let Some(node) = ids.get(id.as_str()).copied() {
                ids.insert(alias, node);
            }
        }
        ids
    }
}

/// Reads `text`, which came from a file `name` in `folder`, and everything it includes.
pub(crate) fn load(
    text: &str,
    name: &str,
    file: Option<&Path>,
    folder: &Path,
    defines: &[(String, String)],
) -> Result<Tree, SceneError> {
    let source = Arc::new(Source { name: name.into(), text: text.into() });
    let mut loader = Loader {
        definitions: Definitions::new(defines),
        folders: vec![folder.to_path_buf()],
        open: file.and_then(|f| f.canonicalize().ok()).into_iter().collect(),
        ids: HashMap::new(),
        aliases: HashMap::new(),
        count: 0,
        includes: 0,
    };
    let mut nodes = Vec::new();
    loader.document(&source, folder, None, 0, &mut nodes)?;
    loader.definitions.all_used(&source)?;
    let Some(root) = nodes.pop() else { return Err(Place::new(&source, 0..0).error("no element, expected <scene>")) };
    if root.tag != "scene" {
        return Err(root.place.error(format!("root element <{}>, expected <scene>", root.tag)));
    }
    Ok(Tree { root, aliases: loader.aliases, folders: loader.folders })
}

struct Loader {
    definitions: Definitions,
    folders: Vec<PathBuf>,
    /// Files being read, outermost first.
    open: Vec<PathBuf>,
    ids: HashMap<String, Place>,
    aliases: HashMap<String, String>,
    count: usize,
    includes: usize,
}

/// What holds for the elements of one file.
struct Context<'a> {
    source: &'a Arc<Source>,
    folder: &'a Path,
    old: bool,
    depth: usize,
}

impl Loader {
    /// Appends the root element of a document; that of an included `<scene>` gives its children instead.
    fn document(
        &mut self,
        source: &Arc<Source>,
        folder: &Path,
        including: Option<bool>,
        depth: usize,
        out: &mut Vec<Node>,
    ) -> Result<(), SceneError> {
        let document = roxmltree::Document::parse(&source.text).map_err(|e| syntax_error(source, &e))?;
        let root = document.root_element();
        let place = Place::new(source, root.range().start..root.range().start + 1 + root.tag_name().name().len());
        let old = match root.attribute_node("version") {
            Some(version) => is_old(version.value(), &Place::new(source, version.range_value()))?,
            None => including.ok_or_else(|| {
                place.error(format!("<{}> without \"version\", expected one such as \"3.0.0\"", root.tag_name().name()))
            })?,
        };
        let context = Context { source, folder, old, depth };
        if including.is_some() && root.tag_name().name() == "scene" {
            self.children(root, &context, true, out)
        } else {
            self.element(root, &context, false, out)
        }
    }

    fn children(
        &mut self,
        parent: roxmltree::Node,
        context: &Context,
        of_root: bool,
        out: &mut Vec<Node>,
    ) -> Result<(), SceneError> {
        for child in parent.children() {
            if child.is_element() {
                self.element(child, context, of_root, out)?;
            } else if child.is_text() && child.text().is_some_and(|t| !t.trim().is_empty()) {
                let start = child.range().start + child.text().map_or(0, |t| t.len() - t.trim_start().len());
                return Err(Place::new(context.source, start..start + 1).error("text, expected an element"));
            }
        }
        Ok(())
    }

    fn element(
        &mut self,
        element: roxmltree::Node,
        context: &Context,
        of_root: bool,
        out: &mut Vec<Node>,
    ) -> Result<(), SceneError> {
        let tag = element.tag_name().name();
        let start = element.range().start;
        let place = Place::new(context.source, start..start + 1 + tag.len());
        if context.depth > DEEPEST {
            return Err(place.error(format!("element nested more than {DEEPEST} deep, expected a flatter file")));
        }
        let Some((_, known)) = ELEMENTS.iter().find(|(name, _)| *name == tag) else {
            let names: Vec<&str> = ELEMENTS.iter().map(|(name, _)| *name).collect();
            return Err(place.error_with_help(
                format!("unknown element <{tag}>, expected an element of Mitsuba's format"),
                nearest(tag, names).map(|name| format!("did you mean <{name}>?")),
            ));
        };
        let mut attributes = Vec::new();
        for attribute in element.attributes() {
            if !known.contains(&attribute.name()) {
                return Err(Place::new(context.source, attribute.range_qname()).error_with_help(
                    format!("unknown attribute \"{}\" in <{tag}>", attribute.name()),
                    advise(attribute.name(), "attributes", known),
                ));
            }
            let place = Place::new(context.source, attribute.range_value());
            let value = self.definitions.substitute(attribute.value(), &place)?;
            attributes.push(Attribute { name: attribute.name().into(), value, place });
        }
        let index = self.count;
        self.count += 1;
        let mut node = Node { index, tag: tag.into(), place, attributes, children: Vec::new(), old: context.old };
        match tag {
            "default" => self.definitions.default(&node.required("name")?.value, &node.required("value")?.value),
            "include" => return self.include(node.required("filename")?, context, out),
            "path" => self.path(&node, context, of_root)?,
            "alias" => self.alias(&node)?,
            _ => {
                if let Some(id) = node.attribute("id").filter(|_| node.is_object()) {
                    self.new_id(id)?;
                }
                let inner = Context { depth: context.depth + 1, ..*context };
                self.children(element, &inner, tag == "scene", &mut node.children)?;
                out.push(node);
            }
        }
        Ok(())
    }

    fn new_id(&mut self, id: &Attribute) -> Result<(), SceneError> {
        match self.ids.insert(id.value.clone(), id.place.clone()) {
            Some(previous) => Err(id.place.error(format!(
                "id \"{}\" again, expected a new one (first in {})",
                id.value,
                previous.label()
            ))),
            None => Ok(()),
        }
    }

    fn alias(&mut self, node: &Node) -> Result<(), SceneError> {
        let (id, alias) = (node.required("id")?, node.required("as")?);
        if !self.ids.contains_key(&id.value) {
            return Err(id.place.error_with_help(
                format!("alias of unknown id \"{}\", expected the id of an earlier object", id.value),
                nearest(&id.value, self.ids.keys().map(String::as_str)).map(|name| format!("did you mean \"{name}\"?")),
            ));
        }
        self.new_id(alias)?;
        let id = self.aliases.get(&id.value).unwrap_or(&id.value).clone();
        self.aliases.insert(alias.value.clone(), id);
        Ok(())
    }

    fn path(&mut self, node: &Node, context: &Context, of_root: bool) -> Result<(), SceneError> {
        let value = node.required("value")?;
        if !of_root {
            return Err(node.place.error("<path> inside another element, expected it directly in <scene>"));
        }
        let folder = context.folder.join(&value.value);
        if !folder.is_dir() {
            return Err(value
                .place
                .error(format!("\"{}\" is no folder, expected one to search for files", value.value)));
        }
        self.folders.insert(0, folder);
        Ok(())
    }

    fn include(&mut self, filename: &Attribute, context: &Context, out: &mut Vec<Node>) -> Result<(), SceneError> {
        let Some(path) = find(&self.folders, &filename.value) else {
            return Err(not_found(&self.folders, filename));
        };
        let unreadable = |e: std::io::Error| filename.place.error(format!("cannot read \"{}\": {e}", filename.value));
        let canonical = path.canonicalize().map_err(unreadable)?;
        if self.open.contains(&canonical) {
            return Err(filename.place.error(format!("\"{}\" includes itself, expected no cycle", filename.value)));
        }
        if context.depth + self.open.len() > DEEPEST {
            return Err(filename.place.error(format!("includes nested more than {DEEPEST} deep, expected fewer")));
        }
        self.includes += 1;
        if self.includes > MOST_INCLUDES {
            return Err(filename.place.error(format!("more than {MOST_INCLUDES} included files, expected fewer")));
        }
        let text = std::fs::read_to_string(&path).map_err(unreadable)?;
        let source = Arc::new(Source { name: path.display().to_string(), text: text.into() });
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        self.open.push(canonical);
        self.document(&source, &folder, Some(context.old), context.depth, out)?;
        self.open.pop();
        Ok(())
    }
}

/// The first existing file of that name.
pub(crate) fn find(folders: &[PathBuf], name: &str) -> Option<PathBuf> {
    folders.iter().map(|folder| folder.join(name)).find(|path| path.is_file())
}

/// The error when [`find`] finds nothing.
pub(crate) fn not_found(folders: &[PathBuf], filename: &Attribute) -> SceneError {
    let list: Vec<String> = folders.iter().map(|f| f.display().to_string()).collect();
    filename.place.error_with_help(
        format!("file \"{}\" not found, expected it in a search folder", filename.value),
        Some(format!("searched: {}", list.join(", "))),
    )
}

fn syntax_error(source: &Arc<Source>, error: &roxmltree::Error) -> SceneError {
    let position = error.pos();
    let line_start: usize =
        source.text.split_inclusive('\n').take((position.row as usize).saturating_sub(1)).map(str::len).sum();
    let column = (position.col as usize).saturating_sub(1);
    let start = line_start + source.text[line_start..].chars().take(column).map(char::len_utf8).sum::<usize>();
    // The parser's own words repeat the position.
    let words = error.to_string().replace(&format!(" at {position}"), "");
    Place::new(source, start..start + 1).error(format!("XML syntax: {words}"))
}

fn is_old(version: &str, place: &Place) -> Result<bool, SceneError> {
    let numbers: Option<Vec<u32>> = version.trim().split('.').map(|part| part.parse().ok()).collect();
    match numbers.as_deref() {
        Some([major, ..]) if *major <= 3 => Ok(*major < 2),
        _ => Err(place.error(format!("version \"{version}\", expected one from 0.5.0 to 3.x"))),
    }
}
