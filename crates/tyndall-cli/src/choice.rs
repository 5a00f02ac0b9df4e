//! The integrator and its parameters, from the scene and from the command line.

use crate::console::Console;
use crate::failure::Failure;
use tyndall::integrators::{self, Integrator, IntegratorInfo, ParameterError, ParameterInfo, REGISTRY};
use tyndall::scene::desc::{IntegratorDesc, ParameterValue};
use tyndall_formats::mitsuba::Loaded;

/// Parameters of the scene's integrator that another one takes over if it knows them.
const COMMON: [&str; 3] = ["max_depth", "rr_depth", "hide_emitters"];

/// The entry called `name`; an error that names the nearest if there is none.
pub(crate) fn find(name: &str) -> Result<&'static IntegratorInfo, Failure> {
    integrators::find(name).ok_or_else(|| Failure::unknown("integrator", name, REGISTRY.iter().map(|info| info.name)))
}

/// The scene's integrator, or `chosen` in its place, with the parameters in `set`, all of them checked.
pub(crate) fn choose(
    loaded: &Loaded,
    chosen: Option<&'static IntegratorInfo>,
    set: &[(String, String)],
    console: Console,
) -> Result<IntegratorDesc, Failure> {
    let scene = &loaded.scene.integrator;
    let mut desc = chosen.map_or_else(|| scene.clone(), |info| replace(scene, info, console));
    // What the scene says is checked first: its mistakes are not those of the command line.
    match integrators::make(&desc) {
        // What takes which component may be about to be set.
        Err(ParameterError::Components { .. }) if chosen.is_some() || !set.is_empty() => {}
        Err(error) => return Err(Failure::scene(&loaded.integrator.error(&error))),
        Ok(_) => {}
    }
    let info = find(&desc.name)?;
    for (key, value) in set {
        if !info.takes(key) {
            let what = format!("parameter of `{}`", info.name);
            return Err(Failure::unknown(&what, key, info.parameters.iter().map(|p| p.name)));
        }
        desc.parameters.retain(|(name, _)| name != key);
        desc.parameters.push((key.clone(), ParameterValue::Text(value.clone())));
    }
    integrators::make(&desc).map_err(Failure::usage)?;
    Ok(desc)
}

/// The integrator of `desc`, all of whose parameters are those of the scene: mistakes are shown there.
pub(crate) fn make(desc: &IntegratorDesc, loaded: &Loaded) -> Result<Box<dyn Integrator>, Failure> {
    integrators::make(desc).map_err(|error| Failure::scene(&loaded.integrator.error(&error)))
}

/// `info` in place of the scene's integrator.
fn replace(scene: &IntegratorDesc, info: &'static IntegratorInfo, console: Console) -> IntegratorDesc {
    if integrators::find(&scene.name).is_some_and(|old| old.name == info.name) {
        return scene.clone();
    }
    let known = |name: &str| COMMON.contains(&name) && info.parameters.iter().any(|p| p.name == name);
    let (kept, dropped): (Vec<_>, Vec<_>) = scene.parameters.iter().cloned().partition(|(name, _)| known(name));
    let names =
        |list: &[(String, ParameterValue)]| list.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
    if !kept.is_empty() {
        console.detail(format_args!("kept from the scene's `{}`: {}", scene.name, names(&kept)));
    }
    if !dropped.is_empty() {
        console.detail(format_args!("dropped from the scene's `{}`: {}", scene.name, names(&dropped)));
    }
    IntegratorDesc { name: info.name.into(), parameters: kept }
}

/// The values of all parameters of the integrator in use: `max_depth=-1 rr_depth=5`.
pub(crate) fn parameters(desc: &IntegratorDesc) -> String {
    let declared = integrators::find(&desc.name).map_or(&[][..], |info| info.parameters);
    let value = |info: &ParameterInfo| {
        let given = desc.parameters.iter().rev().find(|(name, _)| name == info.name);
        format!("{}={}", info.name, given.map_or(info.default.into(), |(_, value)| text(value)))
    };
    let of_parts = desc.parameters.iter().filter(|(name, _)| name.contains('.'));
    let of_parts = of_parts.map(|(name, value)| format!("{name}={}", text(value)));
    declared.iter().map(value).chain(of_parts).collect::<Vec<_>>().join(" ")
}

fn text(value: &ParameterValue) -> String {
    match value {
        ParameterValue::Integer(i) => i.to_string(),
        ParameterValue::Float(f) => f.to_string(),
        ParameterValue::Boolean(b) => b.to_string(),
        ParameterValue::Text(t) => t.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use tyndall_formats::mitsuba;

    fn scene() -> Loaded {
        let text = r#"<scene version="3.0.0"><integrator type="volpathmis"><integer name="max_depth" value="7"/>
            <integer name="equiangular_legs" value="1"/></integrator></scene>"#;
        mitsuba::read_str(text, Path::new("."), &mitsuba::Options::default()).unwrap()
    }

    #[test]
    fn another_integrator_keeps_what_it_knows() {
        let quiet = Console { level: crate::console::Level::Quiet };
        let path = choose(&scene(), find("path").ok(), &[], quiet).unwrap();
        assert_eq!(path.parameters, [("max_depth".into(), ParameterValue::Integer(7))]);
        assert_eq!(parameters(&path), "max_depth=7 rr_depth=5 hide_emitters=false");
        // The same one by another name.
        assert_eq!(choose(&scene(), find("volpath").ok(), &[], quiet).unwrap(), scene().scene.integrator);
    }

    #[test]
    fn set_replaces() {
        let quiet = Console { level: crate::console::Level::Quiet };
        let set = |key: &str, value: &str| choose(&scene(), find("path").ok(), &[(key.into(), value.into())], quiet);
        assert!(parameters(&set("max_depth", "3").unwrap()).starts_with("max_depth=3 "));
        assert!(matches!(set("max_dept", "3"), Err(Failure::Usage(m)) if m.contains("`max_depth`?")));
        assert!(matches!(set("max_depth", "three"), Err(Failure::Usage(m)) if m.contains("a whole number")));
        assert!(matches!(set("max_depth", "-7"), Err(Failure::Usage(_))));
    }
}
