//! `composite`: every part of the transport by the integrator that is best at it.

use super::components::Components;
use super::volpath::common::{HIDE_EMITTERS, MAX_DEPTH};
use super::{
    Counts, Integrator, IntegratorInfo, Job, ParameterError, ParameterInfo, ParameterKind, Parameters, RareEvents,
    find, make,
};
use crate::Spectrum;
use crate::film::Splats;
use crate::film::pixels::PixelSum;
use crate::photons::TraceError;
use crate::scene::Scene;
use crate::scene::desc::{IntegratorDesc, ParameterValue};

const fn part(name: &'static str) -> ParameterInfo {
    ParameterInfo {
        name,
        kind: ParameterKind::Text,
        default: "",
        unit: "",
        description: "Components that it renders, joined by +; its own parameters follow its name and a point.",
    }
}

/// Integrators that can be asked for components, and what all of them are given.
const PARAMETERS: &[ParameterInfo] = &[
    part("volpath"),
    part("jis"),
    part("photonmap"),
    part("vpm"),
    part("bre"),
    part("beams"),
    part("planes"),
    part("ppm"),
    part("pvpm"),
    part("pbre"),
    part("ppb"),
    part("vpl"),
    part("vsl"),
    part("vrl"),
    part("vbl"),
    part("lightcuts"),
    MAX_DEPTH,
    HIDE_EMITTERS,
];

/// The registry's entry.
pub const INFO: IntegratorInfo = IntegratorInfo {
    name: "composite",
    aliases: &[],
    summary: "The sum of other integrators, each for some components of the transport.",
    source: "Novak et al. 2012, Virtual ray lights, section 6",
    parameters: PARAMETERS,
    make: |parameters| Ok(Box::new(Composite::read(parameters)?)),
};

struct Composite {
    parts: Vec<Box<dyn Integrator>>,
}

impl Composite {
    fn read(parameters: &Parameters) -> Result<Self, ParameterError> {
        let mut taken = Components::NONE;
        let mut parts = Vec::new();
        for info in PARAMETERS.iter().filter(|info| find(info.name).is_some()) {
            let text = parameters.text(info.name);
            if text.is_empty() {
                continue;
            }
            let wanted = Components::parse(&text).ok_or_else(|| {
                parameters.out_of_range(
                    info.name,
                    "components joined by +: emitted, direct, indirect, caustic, single, multiple",
                )
            })?;
            let twice = wanted.intersection(taken);
            if twice != Components::NONE {
                return Err(ParameterError::Components {
                    what: format!("`{twice}` is taken twice, again by `{}`", info.name),
                });
            }
            taken = taken.union(wanted);
            // What the part is given itself comes later, and the last one counts.
            let mut nested = vec![
                ("max_depth".into(), ParameterValue::Integer(parameters.integer("max_depth"))),
                ("hide_emitters".into(), ParameterValue::Boolean(parameters.boolean("hide_emitters"))),
            ];
            nested.extend(parameters.nested(info.name));
            nested.push(("components".into(), ParameterValue::Text(text)));
            parts.push(make(&IntegratorDesc { name: info.name.into(), parameters: nested })?);
        }
        let missing = taken.complement();
        if missing != Components::NONE {
            return Err(ParameterError::Components { what: format!("no integrator takes `{missing}`") });
        }
        Ok(Self { parts })
    }
}

impl Integrator for Composite {
    fn warnings(&self, scene: &Scene) -> Vec<String> {
        let mut warnings: Vec<String> = Vec::new();
        for warning in self.parts.iter().flat_map(|part| part.warnings(scene)) {
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        }
        warnings
    }

    fn prepare(&mut self, scene: &Scene, seed: u64, pass: u32) -> Result<u32, TraceError> {
        self.parts.iter_mut().try_fold(u32::MAX, |serves, part| Ok(serves.min(part.prepare(scene, seed, pass)?)))
    }

    fn splats(&self) -> bool {
        self.parts.iter().any(|part| part.splats())
    }

    fn counts(&self) -> Counts {
        let add = |a: Counts, b: Counts| Counts {
            light_paths: a.light_paths + b.light_paths,
            photons: a.photons + b.photons,
            connections: a.connections + b.connections,
            capped: a.capped + b.capped,
        };
        self.parts.iter().map(|part| part.counts()).fold(Counts::default(), add)
    }

    fn render(&self, scene: &Scene, job: &Job, pixels: &mut [PixelSum], splats: &mut Splats) -> RareEvents {
        let mut rare = RareEvents::default();
        let mut sums = vec![PixelSum::default(); pixels.len()];
        for pass in job.passes.clone() {
            let one = Job { passes: pass..pass + 1, ..job.clone() };
            sums.fill(PixelSum::default());
            for part in &self.parts {
                rare.non_finite += part.render(scene, &one, &mut sums, splats).non_finite;
            }
            for (pixel, sum) in pixels.iter_mut().zip(&sums) {
                pixel.add(Spectrum::from_rgb(sum.sum.map(|c| c as f32)));
            }
        }
        rare
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compose(parameters: &[(&str, &str)]) -> Result<Box<dyn Integrator>, ParameterError> {
        let text = |v: &str| ParameterValue::Text(v.into());
        let parameters = parameters.iter().map(|(k, v)| (k.to_string(), text(v))).collect();
        make(&IntegratorDesc { name: "composite".into(), parameters })
    }

    fn error(parameters: &[(&str, &str)]) -> String {
        compose(parameters).err().map(|e| e.to_string()).unwrap_or_default()
    }

    #[test]
    fn every_component_once() {
        let rest = ("volpath", "emitted+direct+indirect+caustic");
        assert!(compose(&[rest, ("beams", "single"), ("bre", "multiple"), ("bre.photons", "1e4")]).is_ok());
        assert_eq!(error(&[rest, ("beams", "single")]), "`composite`: no integrator takes `multiple`");
        let twice = error(&[rest, ("beams", "single+multiple"), ("bre", "multiple")]);
        assert_eq!(twice, "`composite`: `multiple` is taken twice, again by `beams`");
    }

    #[test]
    fn parameters_of_the_parts_are_checked() {
        assert!(error(&[("volpath", "all"), ("volpath.max_dept", "3")]).contains("has no parameter `max_dept`"));
        assert!(error(&[("volpath", "everything")]).contains("must be components joined by +"));
        assert!(
            error(&[("volpath", "all"), ("volpth.max_depth", "3")]).contains("has no parameter `volpth.max_depth`")
        );
    }
}
