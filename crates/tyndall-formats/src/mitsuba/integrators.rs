//! Integrators: by name, with parameters as written.

use super::Reader;
use super::properties::Bag;
use super::source::SceneError;
use super::xml::Node;
use tyndall::scene::desc::IntegratorDesc;

impl<'t> Reader<'t> {
    pub(super) fn integrator(&mut self, node: &'t Node) -> Result<IntegratorDesc, SceneError> {
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
            name => IntegratorDesc { name: name.into(), parameters: bag.rest()? },
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
