//! Experiment files: TOML. Every mistake is shown with its line and column and the nearest known name.

use super::experiment::{Budget, Kind, Method, ReferenceChoice, SceneEntry};
use super::template::Template;
use crate::args;
use crate::choice;
use crate::failure::{Failure, nearest};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;
use toml::Spanned;
use tyndall::integrators::IntegratorInfo;

/// What a file says; the command line goes before it.
#[derive(Debug, Default)]
pub(crate) struct Given {
    pub(crate) title: Option<String>,
    pub(crate) output: Option<PathBuf>,
    pub(crate) budget: Option<Budget>,
    pub(crate) limit: Option<Duration>,
    pub(crate) repeat: Option<u32>,
    pub(crate) seed: Option<u64>,
    pub(crate) threads: Option<u32>,
    pub(crate) size: Option<[u32; 2]>,
    pub(crate) reference_method: Option<&'static IntegratorInfo>,
    pub(crate) reference_limit: Option<Duration>,
    pub(crate) scenes: Vec<SceneEntry>,
    pub(crate) methods: Vec<Method>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Document {
    title: Option<String>,
    output: Option<PathBuf>,
    time: Option<Spanned<String>>,
    samples: Option<Spanned<u32>>,
    error: Option<Spanned<f64>>,
    limit: Option<Spanned<String>>,
    repeat: Option<Spanned<u32>>,
    seed: Option<u64>,
    threads: Option<Spanned<u32>>,
    size: Option<Spanned<String>>,
    reference: Option<String>,
    reference_method: Option<Spanned<String>>,
    reference_limit: Option<Spanned<String>>,
    #[serde(default)]
    define: BTreeMap<String, Value>,
    #[serde(default)]
    scene: Vec<SceneTable>,
    #[serde(default)]
    method: Vec<MethodTable>,
    #[serde(default)]
    external: Vec<ExternalTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneTable {
    path: PathBuf,
    name: Option<String>,
    reference: Option<String>,
    #[serde(default)]
    define: BTreeMap<String, Value>,
    #[serde(default)]
    insets: Vec<Spanned<[u32; 4]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MethodTable {
    integrator: Spanned<String>,
    name: Option<String>,
    #[serde(default)]
    set: BTreeMap<String, Spanned<Value>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ExternalTable {
    name: String,
    command: Spanned<String>,
}

/// A value that is as good as its text.
#[derive(Clone, Deserialize)]
#[serde(untagged)]
enum Value {
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Text(String),
}

impl Value {
    fn text(&self) -> String {
        match self {
            Self::Integer(value) => value.to_string(),
            Self::Float(value) => value.to_string(),
            Self::Boolean(value) => value.to_string(),
            Self::Text(value) => value.clone(),
        }
    }
}

/// A file's text with its name, for messages.
struct Source<'a> {
    path: &'a Path,
    text: &'a str,
}

impl Source<'_> {
    /// `experiment.toml:3:8: `.
    fn place(&self, at: usize) -> String {
        let before = &self.text[..at.min(self.text.len())];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        format!("{}:{line}:{column}: ", self.path.display())
    }

    fn error<T>(&self, value: &Spanned<T>, message: impl std::fmt::Display) -> Failure {
        Failure::other(format_args!("{}{message}", self.place(value.span().start)))
    }

    /// A text that the command line would take.
    fn parse<T>(
        &self,
        value: Option<&Spanned<String>>,
        parse: fn(&str) -> Result<T, String>,
    ) -> Result<Option<T>, Failure> {
        let parsed = value.map(|value| {
            parse(value.get_ref())
                .map_err(|message| self.error(value, format_args!("found `{}`, {message}", value.get_ref())))
        });
        parsed.transpose()
    }

    fn at_least_one(&self, value: Option<&Spanned<u32>>) -> Result<Option<u32>, Failure> {
        match value {
            Some(value) if *value.get_ref() == 0 => Err(self.error(value, "found 0, expected a whole number from 1")),
            other => Ok(other.map(|value| *value.get_ref())),
        }
    }

    fn integrator(&self, name: &Spanned<String>) -> Result<&'static IntegratorInfo, Failure> {
        choice::find(name.get_ref()).map_err(|failure| self.error(name, failure))
    }
}

/// Reads a file. Its paths are looked for from its own folder.
pub(crate) fn read(path: &Path) -> Result<Given, Failure> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::other(format_args!("{}: cannot be read: {error}", path.display())))?;
    parse(path, &text)
}

fn parse(path: &Path, text: &str) -> Result<Given, Failure> {
    let source = Source { path, text };
    let document: Document = toml::from_str(text).map_err(|error| {
        let place = error.span().map_or_else(|| format!("{}: ", path.display()), |span| source.place(span.start));
        Failure::other(format_args!("{place}{}{}", error.message(), guess(error.message())))
    })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let budgets = [
        source.parse(document.time.as_ref(), args::duration)?.map(Budget::Time),
        source.at_least_one(document.samples.as_ref())?.map(Budget::Samples),
        match &document.error {
            Some(value) if !(*value.get_ref() > 0.0) => {
                return Err(source.error(value, "expected an error above 0, such as 0.05"));
            }
            other => other.as_ref().map(|value| Budget::Error(*value.get_ref())),
        },
    ];
    if budgets.iter().flatten().count() > 1 {
        return Err(Failure::other(format_args!(
            "{}: expected one of time, samples and error, found more",
            path.display()
        )));
    }
    let scene = |table: SceneTable| {
        let stem = || table.path.file_stem().unwrap_or("scene".as_ref()).to_string_lossy().into_owned();
        let reference = table.reference.as_deref().or(document.reference.as_deref()).unwrap_or("auto");
        let mut define = document.define.clone();
        define.extend(table.define.clone());
        if let Some(empty) = table.insets.iter().find(|inset| inset.get_ref()[2] == 0 || inset.get_ref()[3] == 0) {
            return Err(
                source.error(empty, "expected left, top, width and height of an inset, found one without pixels")
            );
        }
        Ok(SceneEntry {
            name: table.name.clone().unwrap_or_else(stem),
            path: folder.join(&table.path),
            define: define.into_iter().map(|(name, value)| (name, value.text())).collect(),
            reference: ReferenceChoice::new(reference, folder),
            insets: table.insets.into_iter().map(Spanned::into_inner).collect(),
        })
    };
    let scenes = document.scene.into_iter().map(scene).collect::<Result<_, _>>()?;
    let mut methods = Vec::new();
    for table in &document.method {
        let info = source.integrator(&table.integrator)?;
        for (key, value) in &table.set {
            if !info.takes(key) {
                let known = info.parameters.iter().map(|p| p.name);
                let failure = Failure::unknown(&format!("parameter of `{}`", info.name), key, known);
                return Err(source.error(value, failure));
            }
        }
        let set = table.set.iter().map(|(key, value)| (key.clone(), value.get_ref().text())).collect();
        methods.push(Method {
            name: table.name.clone().unwrap_or_else(|| table.integrator.get_ref().clone()),
            kind: Kind::Integrator { info, set },
            place: source.place(table.integrator.span().start),
        });
    }
    for table in &document.external {
        let template =
            Template::new(table.command.get_ref()).map_err(|message| source.error(&table.command, message))?;
        let place = source.place(table.command.span().start);
        methods.push(Method { name: table.name.clone(), kind: Kind::External(template), place });
    }
    Ok(Given {
        title: document.title,
        output: document.output.map(|output| folder.join(output)),
        budget: budgets.into_iter().flatten().next(),
        limit: source.parse(document.limit.as_ref(), args::duration)?,
        repeat: source.at_least_one(document.repeat.as_ref())?,
        seed: document.seed,
        threads: source.at_least_one(document.threads.as_ref())?,
        size: source.parse(document.size.as_ref(), args::size)?,
        reference_method: document.reference_method.as_ref().map(|name| source.integrator(name)).transpose()?,
        reference_limit: source.parse(document.reference_limit.as_ref(), args::duration)?,
        scenes,
        methods,
    })
}

/// `; did you mean ...?` for a message such as "unknown field `tme`, expected one of `time`, `samples`".
fn guess(message: &str) -> String {
    let mut quoted = message.split('`').skip(1).step_by(2);
    match quoted.next().filter(|_| message.starts_with("unknown field")) {
        Some(found) => {
            let known: Vec<&str> = quoted.collect();
            nearest(found, &known).map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
        }
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = r#"
title = "Fog"
time = "1m30s"
repeat = 3
size = "64x48"
reference = "none"
[define]
spp = 4
[[scene]]
path = "box.xml"
define = { density = 0.5 }
insets = [[1, 2, 3, 4]]
[[scene]]
path = "sub/ball.xml"
name = "ball"
reference = "ball.exr"
[[method]]
integrator = "vpm"
set = { photons = 1e5 }
[[method]]
name = "wide"
integrator = "beams"
[[external]]
name = "mitsuba"
command = "mitsuba -Dspp={spp} -o {out} {scene}"
"#;

    #[test]
    fn an_experiment() {
        let given = parse(Path::new("here/e.toml"), GOOD).unwrap();
        assert_eq!(given.budget, Some(Budget::Time(Duration::from_secs(90))));
        assert_eq!((given.repeat, given.size), (Some(3), Some([64, 48])));
        let [scene, ball] = &given.scenes[..] else { panic!("{:?}", given.scenes) };
        assert_eq!((scene.name.as_str(), scene.path.as_path()), ("box", Path::new("here/box.xml")));
        assert_eq!(scene.define, [("density".into(), "0.5".into()), ("spp".into(), "4".into())]);
        assert_eq!((scene.reference.clone(), scene.insets.clone()), (ReferenceChoice::None, vec![[1, 2, 3, 4]]));
        assert_eq!(ball.reference, ReferenceChoice::File("here/ball.exr".into()));
        let names: Vec<&str> = given.methods.iter().map(|m| m.name.as_str()).collect();
        assert_eq!(names, ["vpm", "wide", "mitsuba"]);
        let Kind::Integrator { set, .. } = &given.methods[0].kind else { panic!() };
        assert_eq!(set[..], [("photons".to_owned(), "100000".to_owned())]);
    }

    #[test]
    fn mistakes_have_places() {
        let message = |text: &str| parse(Path::new("e.toml"), text).unwrap_err().to_string();
        let cases = [
            ("tme = \"3s\"", "e.toml:1:1: unknown field `tme`", "did you mean `time`?"),
            ("title = \"a\"\ntime = \"3 parsecs\"", "e.toml:2:8: found `3 parsecs`", "such as 30s"),
            ("repeat = 0", "e.toml:1:10: found 0", "from 1"),
            ("samples = -3", "e.toml:1:11: ", "-3"),
            ("error = 0.0", "e.toml:1:9: ", "above 0"),
            ("time = \"3s\"\nsamples = 3", "e.toml: ", "one of"),
            ("[[method]]\nintegrator = \"volpth\"", "e.toml:2:14: there is no integrator `volpth`", "`volpath`"),
            (
                "[[method]]\nintegrator = \"vpm\"\nset = { photns = 3 }",
                "e.toml:3:18: there is no parameter of `vpm`",
                "`photons`",
            ),
            ("[[external]]\nname = \"m\"\ncommand = \"m {spp}\"", "e.toml:3:11: ", "{scene}"),
            ("[[scene]]\npath = \"a\"\ninsets = [[1, 2, 0, 4]]", "e.toml:3:11: ", "without pixels"),
            ("[[scene]]\nname = \"a\"", "e.toml:1:1: ", "path"),
            ("time = ", "e.toml:1:", ""),
        ];
        for (text, place, hint) in cases {
            let found = message(text);
            assert!(found.starts_with(place) && found.contains(hint), "{text}\n{found}");
        }
    }
}
