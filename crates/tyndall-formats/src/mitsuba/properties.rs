//! The parameters and children of one plugin, typed, with their places, and a memory of which were asked for.

use super::numbers;
use super::source::{Place, SceneError, advise, nearest};
use super::upgrade;
use super::xml::{Attribute, Node};
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use tyndall::math::Transform;
use tyndall::scene::desc::{ParameterValue, Rgb};

/// What an element says.
#[derive(Debug)]
pub(crate) enum Value<'t> {
    Float(f64),
    Integer(i64),
    Boolean(bool),
    Text(&'t Attribute),
    Vector([f64; 3]),
    Rgb(Rgb),
    /// `<spectrum value="c"/>`.
    Flat(f64),
    /// `<spectrum value="wavelength:value, ..."/>`.
    Wavelengths(Vec<[f64; 2]>),
    /// `<spectrum filename="..."/>`.
    SpectrumFile(&'t Attribute),
    /// Temperature in kelvin, factor.
    Blackbody(f64, f64),
    Transform(Transform),
    Object(&'t Node),
}

impl Value<'_> {
    fn kind(&self) -> String {
        match self {
            Self::Float(_) => "a number".into(),
            Self::Integer(_) => "a whole number".into(),
            Self::Boolean(_) => "a boolean".into(),
            Self::Text(_) => "a string".into(),
            Self::Vector(_) => "a vector".into(),
            Self::Rgb(_) => "a colour".into(),
            Self::Flat(_) | Self::Wavelengths(_) | Self::SpectrumFile(_) | Self::Blackbody(..) => "a spectrum".into(),
            Self::Transform(_) => "a transform".into(),
            Self::Object(node) => article(node.family()),
        }
    }
}

fn article(word: &str) -> String {
    let vowel = word.starts_with(['a', 'e', 'i', 'o', 'u']);
    format!("{} {word}", if vowel { "an" } else { "a" })
}

/// One parameter or child.
#[derive(Debug)]
pub(crate) struct Property<'t> {
    /// `None`: a child without a name.
    pub(crate) name: Option<String>,
    /// The value's place; the element's for children.
    pub(crate) place: Place,
    /// The name's place.
    pub(crate) name_place: Place,
    pub(crate) value: Value<'t>,
    used: Cell<bool>,
}

/// The parameters and children of one plugin.
#[derive(Debug)]
pub(crate) struct Bag<'t> {
    pub(crate) node: &'t Node,
    /// The `type` attribute.
    pub(crate) plugin: &'t str,
    properties: Vec<Property<'t>>,
    asked: RefCell<Vec<&'static str>>,
    families: RefCell<Vec<&'static str>>,
}

impl<'t> Bag<'t> {
    pub(crate) fn open(node: &'t Node, ids: &HashMap<&'t str, &'t Node>) -> Result<Self, SceneError> {
        let plugin = if node.tag == "scene" { "scene" } else { &node.required("type")?.value };
        let mut bag =
            Self { node, plugin, properties: Vec::new(), asked: RefCell::default(), families: RefCell::default() };
        for child in &node.children {
            let property = bag.property(child, ids)?;
            if let Some(name) = &property.name
                && bag.properties.iter().any(|p| p.name.as_ref() == Some(name))
            {
                return Err(property.name_place.error(format!("\"{name}\" again, expected it once")));
            }
            bag.properties.push(property);
        }
        Ok(bag)
    }

    fn property(&self, child: &'t Node, ids: &HashMap<&'t str, &'t Node>) -> Result<Property<'t>, SceneError> {
        let (place, value) = value(child, ids)?;
        if !matches!(child.tag.as_str(), "transform") && !child.is_object() && !child.children.is_empty() {
            return Err(child.children[0].place.error(format!("element in <{}>, expected none", child.tag)));
        }
        let name = child.attribute("name");
        if name.is_none() && !matches!(value, Value::Object(_)) {
            return Err(child.place.error(format!("<{}> without \"name\", expected the attribute", child.tag)));
        }
        Ok(Property {
            name: name.map(|n| upgrade::name(self.node, self.plugin, &n.value)),
            name_place: name.map_or_else(|| place.clone(), |n| n.place.clone()),
            place,
            value,
            used: Cell::new(false),
        })
    }

    /// `KIND "PLUGIN"`.
    pub(crate) fn title(&self) -> String {
        if self.plugin == "scene" { "scene".into() } else { format!("{} \"{}\"", self.node.family(), self.plugin) }
    }

    /// The id, or the plugin and where it is written.
    pub(crate) fn label(&self) -> String {
        match self.node.attribute("id") {
            Some(id) => id.value.clone(),
            None => format!("{} at {}", self.plugin, self.node.place.label()),
        }
    }

    /// The place of the plugin's name.
    pub(crate) fn place(&self) -> &Place {
        self.node.attribute("type").map_or(&self.node.place, |a| &a.place)
    }

    /// An error about a plugin that is not known here.
    pub(crate) fn unknown(&self, known: &[&str], unsupported: &[&str]) -> SceneError {
        let family = self.node.family();
        let list = format!("{family} plugins");
        if unsupported.contains(&self.plugin) {
            return self.place().error_with_help(
                format!("{} is not supported, expected one that is", self.title()),
                Some(format!("supported {list}: {}", known.join(", "))),
            );
        }
        self.place().error_with_help(
            format!("unknown {}, expected {} plugin", self.title(), article(family)),
            advise(self.plugin, &list, known),
        )
    }

    /// The parameter of that name.
    pub(crate) fn find(&self, name: &'static str) -> Option<&Property<'t>> {
        let mut asked = self.asked.borrow_mut();
        if !asked.contains(&name) {
            asked.push(name);
        }
        let property = self.properties.iter().find(|p| p.name.as_deref() == Some(name))?;
        property.used.set(true);
        Some(property)
    }

    /// The error that `name` is missing.
    pub(crate) fn missing(&self, name: &str) -> SceneError {
        self.place().error(format!("{} without \"{name}\", expected the parameter", self.title()))
    }

    /// The children of one family.
    pub(crate) fn children(&self, family: &'static str) -> Vec<(&Property<'t>, &'t Node)> {
        self.families.borrow_mut().push(family);
        let mut found = Vec::new();
        for property in &self.properties {
            if let Value::Object(node) = property.value
                && node.family() == family
                && !property.used.get()
            {
                property.used.set(true);
                found.push((property, node));
            }
        }
        found
    }

    /// The only child of one family, if there is one.
    pub(crate) fn child(&self, family: &'static str) -> Result<Option<&'t Node>, SceneError> {
        match self.children(family).as_slice() {
            [] => Ok(None),
            [(_, node)] => Ok(Some(node)),
            [_, (second, _), ..] => {
                Err(second.place.error(format!("a second {family} in {}, expected only one", self.title())))
            }
        }
    }

    /// A number in double precision.
    pub(crate) fn number(&self, name: &'static str) -> Result<Option<(f64, &Place)>, SceneError> {
        let Some(property) = self.find(name) else { return Ok(None) };
        match property.value {
            Value::Float(number) => Ok(Some((number, &property.place))),
            Value::Integer(number) => Ok(Some((number as f64, &property.place))),
            _ => Err(property.wrong("a number")),
        }
    }

    pub(crate) fn double(&self, name: &'static str, default: f64) -> Result<f64, SceneError> {
        Ok(self.number(name)?.map_or(default, |(number, _)| number))
    }

    pub(crate) fn float(&self, name: &'static str, default: f32) -> Result<f32, SceneError> {
        let Some((number, place)) = self.number(name)? else { return Ok(default) };
        Ok(numbers::narrow([number], place)?[0])
    }

    /// A number for which `valid` holds; `expected` says in words what that is.
    pub(crate) fn checked(
        &self,
        name: &'static str,
        default: f32,
        valid: impl Fn(f32) -> bool,
        expected: &str,
    ) -> Result<f32, SceneError> {
        let number = self.float(name, default)?;
        match self.find(name) {
            Some(property) if !valid(number) => {
                Err(property.place.error(format!("{name} {number}, expected {expected}")))
            }
            _ => Ok(number),
        }
    }

    pub(crate) fn integer(&self, name: &'static str) -> Result<Option<(i64, &Place)>, SceneError> {
        let Some(property) = self.find(name) else { return Ok(None) };
        match property.value {
            Value::Integer(number) => Ok(Some((number, &property.place))),
            _ => Err(property.wrong("a whole number")),
        }
    }

    /// A whole number from `smallest` to `largest`.
    pub(crate) fn whole(
        &self,
        name: &'static str,
        default: u32,
        smallest: u32,
        largest: u32,
    ) -> Result<u32, SceneError> {
        let Some((number, place)) = self.integer(name)? else { return Ok(default) };
        match u32::try_from(number) {
            Ok(whole) if (smallest..=largest).contains(&whole) => Ok(whole),
            _ => Err(place.error(format!("{name} {number}, expected a whole number from {smallest} to {largest}"))),
        }
    }

    pub(crate) fn boolean(&self, name: &'static str, default: bool) -> Result<bool, SceneError> {
        let Some(property) = self.find(name) else { return Ok(default) };
        match property.value {
            Value::Boolean(value) => Ok(value),
            _ => Err(property.wrong("a boolean")),
        }
    }

    pub(crate) fn text(&self, name: &'static str) -> Result<Option<&'t Attribute>, SceneError> {
        let Some(property) = self.find(name) else { return Ok(None) };
        match property.value {
            Value::Text(text) => Ok(Some(text)),
            _ => Err(property.wrong("a string")),
        }
    }

    pub(crate) fn required_text(&self, name: &'static str) -> Result<&'t Attribute, SceneError> {
        self.text(name)?.ok_or_else(|| self.missing(name))
    }

    /// One of several words.
    pub(crate) fn choice<T: Copy>(&self, name: &'static str, words: &[(&str, T)], default: T) -> Result<T, SceneError> {
        let Some(text) = self.text(name)? else { return Ok(default) };
        if let Some((_, value)) = words.iter().find(|(word, _)| *word == text.value) {
            return Ok(*value);
        }
        let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
        Err(text.place.error_with_help(
            format!("{name} \"{}\", expected one of: {}", text.value, known.join(", ")),
            nearest(&text.value, known.iter().copied()).map(|n| format!("did you mean \"{n}\"?")),
        ))
    }

    pub(crate) fn vector(&self, name: &'static str) -> Result<Option<([f64; 3], &Place)>, SceneError> {
        let Some(property) = self.find(name) else { return Ok(None) };
        match property.value {
            Value::Vector(v) => Ok(Some((v, &property.place))),
            _ => Err(property.wrong("a point or vector")),
        }
    }

    pub(crate) fn transform(&self, name: &'static str) -> Result<Option<(Transform, &Place)>, SceneError> {
        let Some(property) = self.find(name) else { return Ok(None) };
        match property.value {
            Value::Transform(transform) => Ok(Some((transform, &property.place))),
            _ => Err(property.wrong("a transform")),
        }
    }

    /// `to_world`, which must not have a projective part.
    pub(crate) fn to_world(&self) -> Result<Transform, SceneError> {
        let Some((transform, place)) = self.transform("to_world")? else { return Ok(Transform::IDENTITY) };
        if !transform.is_affine() {
            return Err(place.error("projective to_world, expected a last row of 0 0 0 1"));
        }
        Ok(transform)
    }

    /// Marks parameters that are legitimate but have no meaning here.
    pub(crate) fn ignore(&self, names: &[&'static str]) {
        for name in names {
            self.find(name);
        }
    }

    /// Everything not asked for that is a plain value: the parameters of an integrator.
    pub(crate) fn rest(&self) -> Result<Vec<(&Property<'t>, String, ParameterValue)>, SceneError> {
        let mut parameters = Vec::new();
        for property in self.properties.iter().filter(|p| !p.used.get()) {
            let Some(name) = &property.name else { continue };
            let value = match &property.value {
                Value::Float(value) => ParameterValue::Float(*value),
                Value::Integer(value) => ParameterValue::Integer(*value),
                Value::Boolean(value) => ParameterValue::Boolean(*value),
                Value::Text(text) => ParameterValue::Text(text.value.clone()),
                _ => return Err(property.wrong("a number, boolean or string")),
            };
            property.used.set(true);
            parameters.push((property, name.clone(), value));
        }
        Ok(parameters)
    }

    /// Complains about everything that was never asked for.
    pub(crate) fn close(&self) -> Result<(), SceneError> {
        let Some(property) = self.properties.iter().find(|p| !p.used.get()) else { return Ok(()) };
        let asked = self.asked.borrow();
        let families = self.families.borrow();
        match (&property.name, &property.value) {
            (name, Value::Object(node)) if name.is_none() || asked.is_empty() => {
                let expected = match families.as_slice() {
                    [] => "no children".into(),
                    list => format!("children of these kinds only: {}", list.join(", ")),
                };
                let reference = if property.place.position() == node.place.position() { "" } else { "reference to " };
                let message = format!("{reference}{} in {}, expected {expected}", article(node.family()), self.title());
                Err(property.place.error(message))
            }
            (name, _) => {
                let name = name.as_deref().unwrap_or_default();
                Err(property.name_place.error_with_help(
                    format!("unknown parameter \"{name}\" of {}", self.title()),
                    advise(name, "parameters", &asked).or_else(|| Some("it has no parameters".into())),
                ))
            }
        }
    }
}

impl Property<'_> {
    /// The error that the value is of the wrong type.
    pub(crate) fn wrong(&self, expected: &str) -> SceneError {
        let name = self.name.as_deref().unwrap_or("child");
        self.place.error(format!("\"{name}\" is {}, expected {expected}", self.value.kind()))
    }
}

fn value<'t>(node: &'t Node, ids: &HashMap<&'t str, &'t Node>) -> Result<(Place, Value<'t>), SceneError> {
    if node.is_object() {
        return Ok((node.place.clone(), Value::Object(node)));
    }
    let plain = |f: &dyn Fn(&'t Attribute) -> Result<Value<'t>, SceneError>| {
        let attribute = node.required("value")?;
        Ok((attribute.place.clone(), f(attribute)?))
    };
    match node.tag.as_str() {
        "float" => plain(&|a| numbers::float(a).map(Value::Float)),
        "integer" => plain(&|a| numbers::integer(a).map(Value::Integer)),
        "boolean" => plain(&|a| numbers::boolean(a).map(Value::Boolean)),
        "string" => plain(&|a| Ok(Value::Text(a))),
        "rgb" => plain(&|a| numbers::rgb(a, false).map(Value::Rgb)),
        "srgb" => plain(&|a| numbers::rgb(a, true).map(Value::Rgb)),
        "point" | "vector" => Ok((node.place.clone(), Value::Vector(numbers::triple(node, None)?))),
        "transform" => Ok((node.place.clone(), Value::Transform(numbers::transform(node)?))),
        "blackbody" => blackbody(node),
        "spectrum" => spectrum(node),
        "ref" => {
            let id = node.required("id")?;
            let target = ids.get(id.value.as_str()).ok_or_else(|| {
                id.place.error_with_help(
                    format!("reference to unknown id \"{}\", expected the id of an object", id.value),
                    nearest(&id.value, ids.keys().copied()).map(|n| format!("did you mean \"{n}\"?")),
                )
            })?;
            Ok((id.place.clone(), Value::Object(target)))
        }
        tag => Err(node.place.error(format!("<{tag}> here, expected a parameter or a plugin"))),
    }
}

fn spectrum(node: &Node) -> Result<(Place, Value<'_>), SceneError> {
    if let Some(file) = node.attribute("filename") {
        if node.attribute("value").is_some() {
            return Err(file.place.error("<spectrum> with \"value\" and \"filename\", expected either"));
        }
        return Ok((file.place.clone(), Value::SpectrumFile(file)));
    }
    let attribute = node.required("value")?;
    let place = attribute.place.clone();
    if attribute.value.contains(':') {
        return Ok((place, Value::Wavelengths(numbers::wavelengths(attribute)?)));
    }
    // Before version 2, a colour could be written as a spectrum.
    if node.old && (attribute.value.contains(',') || attribute.value.contains('#')) {
        return Ok((place, Value::Rgb(numbers::rgb(attribute, attribute.value.contains('#'))?)));
    }
    Ok((place, Value::Flat(numbers::float(attribute)?)))
}

fn blackbody(node: &Node) -> Result<(Place, Value<'_>), SceneError> {
    let attribute = node.required("temperature")?;
    let text = attribute.value.trim();
    let kelvin = text.strip_suffix(['k', 'K']).unwrap_or(text);
    let temperature = match numbers::list(kelvin, &attribute.place)?.as_slice() {
        [t] if *t > 0.0 => *t,
        _ => return Err(attribute.place.error(format!("temperature \"{text}\", expected kelvins above 0"))),
    };
    let factor = node.attribute("scale").map_or(Ok(1.0), numbers::float)?;
    Ok((attribute.place.clone(), Value::Blackbody(temperature, factor)))
}
