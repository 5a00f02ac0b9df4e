//! Integrators: by name, with parameters as written, and the places of both.

use super::Reader;
use super::properties::Bag;
use super::source::{Place, SceneError, advise};
use super::xml::Node;
use tyndall::integrators::{self, ParameterError, REGISTRY};
use tyndall::scene::desc::IntegratorDesc;

/// Where a scene says which integrator renders it.
///
/// Reading a scene does not judge its integrator, because whoever renders it may choose another.
#[derive(Clone, Debug)]
pub struct IntegratorSource {
    name: Place,
    parameters: Vec<ParameterSource>,
}

#[derive(Clone, Debug)]
struct ParameterSource {
    name: String,
    name_place: Place,
    value_place: Place,
}

impl IntegratorSource {
    /// No integrator in the scene: whatever is said about it is said about the scene.
    pub(super) fn none(scene: &Place) -> Self {
        Self { name: scene.clone(), parameters: Vec::new() }
    }

    /// What is wrong with the integrator, at the place that says so.
    pub fn error(&self, error: &ParameterError) -> SceneError {
        let parameter = |name: &str| self.parameters.iter().find(|p| p.name == name);
        match error {
            ParameterError::UnknownIntegrator { name, .. } => {
                let known: Vec<&str> = REGISTRY.iter().map(|info| info.name).collect();
                self.name.error_with_help(
                    format!("unknown integrator \"{name}\", expected a known one"),
                    advise(name, "integrators", &known),
                )
            }
            ParameterError::UnknownParameter { integrator, name, .. } => {
                let declared = integrators::find(integrator).map_or(&[][..], |info| info.parameters);
                let known: Vec<&str> = declared.iter().map(|info| info.name).collect();
                parameter(name).map_or(&self.name, |p| &p.name_place).error_with_help(
                    format!("unknown parameter \"{name}\" of integrator \"{integrator}\""),
                    advise(name, "parameters", &known).or_else(|| Some("it has no parameters".into())),
                )
            }
            ParameterError::Components { .. } => self.name.error(error.to_string()),
            ParameterError::WrongKind { name, .. } | ParameterError::OutOfRange { name, .. } => {
                parameter(name).map_or(&self.name, |p| &p.value_place).error(error.to_string())
            }
        }
    }
}

impl<'t> Reader<'t> {
    pub(super) fn integrator(&mut self, node: &'t Node) -> Result<(IntegratorDesc, IntegratorSource), SceneError> {
        let bag = self.open(node)?;
        self.drop_settings(&bag)?;
        let integrator = match bag.plugin {
            // These only add channels to the picture of another one.
            "moment" | "aov" => {
                if let Some(aovs) = bag.text("aovs")? {
                    self.warn(&aovs.place, "further channels of the picture are not supported and left out");
                }
                let Some(nested) = bag.child("integrator")? else {
                    return Err(bag
                        .place()
                        .error(format!("{} without a nested integrator, expected one", bag.title())));
                };
                self.integrator(nested)?
            }
            plugin => {
                let mut desc = IntegratorDesc { name: plugin.into(), parameters: Vec::new() };
                let mut source = IntegratorSource { name: bag.place().clone(), parameters: Vec::new() };
                for (property, name, value) in bag.rest()? {
                    source.parameters.push(ParameterSource {
                        name: name.clone(),
                        name_place: property.name_place.clone(),
                        value_place: property.place.clone(),
                    });
                    desc.parameters.push((name, value));
                }
                (desc, source)
            }
        };
        self.close(&bag)?;
        Ok(integrator)
    }

    /// Reads what says how Mitsuba should work rather than what the picture is.
    fn drop_settings(&mut self, bag: &Bag<'t>) -> Result<(), SceneError> {
        bag.integer("samples_per_pass")?;
        bag.integer("block_size")?;
        if let Some((seconds, place)) = bag.number("timeout")?
            && seconds > 0.0
        {
            self.warn(place, format!("timeout {seconds} is ignored: all samples are taken however long it lasts"));
        }
        if bag.plugin == "direct" {
            for name in ["emitter_samples", "bsdf_samples", "shading_samples"] {
                if let Some((count, place)) = bag.integer(name)?
                    && count != 1
                {
                    self.warn(place, format!("{name} {count} is ignored: each path takes one sample of either kind"));
                }
            }
        }
        Ok(())
    }
}
