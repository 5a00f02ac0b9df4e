//! Integrators: by name, with parameters as written.

use super::Reader;
use super::source::SceneError;
use super::xml::Node;
use tyndall::scene::desc::IntegratorDesc;

impl<'t> Reader<'t> {
    pub(super) fn integrator(&mut self, node: &'t Node) -> Result<IntegratorDesc, SceneError> {
        let bag = self.open(node)?;
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
}
