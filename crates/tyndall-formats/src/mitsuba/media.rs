//! Participating media.

use super::Reader;
use super::properties::Bag;
use super::source::SceneError;
use super::textures::Quantity::{Extinction, Reflectance, Unbounded};
use super::volumes::offender;
use super::xml::Node;
use tyndall::scene::desc::{MediumDesc, MediumId, MediumKind, PhaseDesc, VolumeDesc};

const KNOWN: &[&str] = &["homogeneous", "heterogeneous"];
const UNSUPPORTED: &[&str] = &["piecewise", "eradiate_homogeneous", "eradiate_heterogeneous"];

impl<'t> Reader<'t> {
    /// The medium, read once however often it is referred to.
    pub(super) fn medium(&mut self, node: &'t Node) -> Result<MediumId, SceneError> {
        if let Some(id) = self.media.get(&node.index) {
            return Ok(*id);
        }
        let bag = self.open(node)?;
        let mut kind = match bag.plugin {
            "homogeneous" => MediumKind::Homogeneous,
            "heterogeneous" => MediumKind::Heterogeneous,
            _ => return Err(bag.unknown(KNOWN, UNSUPPORTED)),
        };
        let (sigma_t, albedo) = match node.old {
            true => self.old_coefficients(&bag, kind)?,
            false => (self.volume(&bag, "sigma_t", 1.0, Extinction)?, self.volume(&bag, "albedo", 0.75, Reflectance)?),
        };
        // Before version 2, constant volumes had no box.
        if node.old && matches!(sigma_t, VolumeDesc::Constant { .. }) {
            kind = MediumKind::Homogeneous;
        }
        if kind == MediumKind::Homogeneous
            && let (VolumeDesc::Grid { .. }, Some(property)) = (&sigma_t, bag.find("sigma_t"))
        {
            return Err(property.wrong("a constant; only heterogeneous media vary"));
        }
        let place = |name| bag.find(name).map_or_else(|| bag.place().clone(), |p| p.place.clone());
        if let Some(value) = offender(&sigma_t, |v| v >= 0.0) {
            return Err(place("sigma_t").error(format!("sigma_t {value}, expected none below 0")));
        }
        if let Some(value) = offender(&albedo, |v| (0.0..=1.0).contains(&v)) {
            return Err(place("albedo").error(format!("albedo {value}, expected numbers in [0, 1]")));
        }
        bag.ignore(&["has_spectral_extinction"]);
        let medium = MediumDesc {
            name: bag.label(),
            kind,
            sigma_t,
            albedo,
            scale: bag.checked("scale", 1.0, |s| s >= 0.0, "a number not below 0")?,
            sample_emitters: bag.boolean("sample_emitters", true)?,
            phase: match bag.child("phase")? {
                Some(node) => self.phase(node)?,
                None => PhaseDesc::Isotropic,
            },
        };
        self.close(&bag)?;
        let id = MediumId(self.scene.media.len());
        self.scene.media.push(medium);
        self.media.insert(node.index, id);
        Ok(id)
    }

    /// Extinction and albedo as versions before 2 write them.
    fn old_coefficients(&mut self, bag: &Bag<'t>, kind: MediumKind) -> Result<(VolumeDesc, VolumeDesc), SceneError> {
        if let Some(material) = bag.text("material")? {
            return Err(material.place.error_with_help(
                format!("material preset \"{}\" is not supported, expected coefficients", material.value),
                Some("write sigmaS and sigmaA in 1/m, or sigmaT and albedo".into()),
            ));
        }
        if kind == MediumKind::Heterogeneous {
            bag.choice("method", &[("woodcock", ()), ("simpson", ())], ())?;
            bag.ignore(&["step_size"]);
            if bag.find("sigma_t").is_none() {
                return Err(bag.missing("density"));
            }
            return Ok((self.volume(bag, "sigma_t", 1.0, Unbounded)?, self.volume(bag, "albedo", 0.75, Reflectance)?));
        }
        match (bag.find("sigma_s"), bag.find("sigma_a")) {
            (Some(_), Some(_)) => {}
            (None, None) => {
                if bag.find("sigma_t").is_none() {
                    let albedo = bag.find("albedo").is_some();
                    return Err(bag.missing(if albedo { "sigma_t" } else { "sigma_s" }));
                }
                return Ok((
                    self.volume(bag, "sigma_t", 1.0, Unbounded)?,
                    self.volume(bag, "albedo", 0.75, Reflectance)?,
                ));
            }
            (Some(_), None) => return Err(bag.missing("sigma_a")),
            (None, Some(_)) => return Err(bag.missing("sigma_s")),
        }
        let scattering = self.color(bag, "sigma_s", 0.0, Unbounded)?;
        let absorption = self.color(bag, "sigma_a", 0.0, Unbounded)?;
        for (name, value) in [("sigma_s", scattering), ("sigma_a", absorption)] {
            if let (Some(v), Some(property)) = (value.iter().find(|v| **v < 0.0), bag.find(name)) {
                return Err(property.place.error(format!("{name} {v}, expected none below 0")));
            }
        }
        let sigma_t = [0, 1, 2].map(|i| scattering[i] + absorption[i]);
        let albedo = [0, 1, 2].map(|i| if sigma_t[i] > 0.0 { (scattering[i] / sigma_t[i]).min(1.0) } else { 0.0 });
        Ok((VolumeDesc::constant(sigma_t), VolumeDesc::constant(albedo)))
    }

    /// The medium around an emitter or sensor.
    pub(super) fn surrounding(&mut self, bag: &Bag<'t>) -> Result<Option<MediumId>, SceneError> {
        bag.child("medium")?.map(|node| self.medium(node)).transpose()
    }
}
