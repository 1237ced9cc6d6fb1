//! Irradiance meters: sensors that stand inside the shape whose surface they measure.

use super::{Builder, files::Files, film, properties::Object, sensor, vocabulary::Class};
use crate::{
    load::LoadError,
    scene::{Integrator, Projection, Sensor},
};

pub(super) const PLUGIN: &str = "irradiancemeter";

/// The sensor of the shape at this place of the description.
fn build(object: Object, shape: u32, files: &mut Files) -> Result<Sensor, LoadError> {
    let film = film::build(object, files)?;
    if (film.width, film.height) != (1, 1) {
        let (width, height) = (film.width, film.height);
        return Err(object
            .error(format!("a meter measures one number, but its film has {width} × {height} pixels"))
            .help("set `width` and `height` of its film to 1"));
    }
    let sampler = sensor::sampler(object, files)?;
    object.finish()?;
    let projection = Projection::IrradianceMeter { shape };
    Ok(Sensor { projection, film, sampler, ..Sensor::default() })
}

impl Builder {
    /// The meter in a shape that becomes the description's next one: it is what the scene is seen by, if nothing is
    /// yet.
    pub(super) fn meter(&mut self, shape: Object) -> Result<(), LoadError> {
        let Some(object) = shape.child(Class::Sensor)? else { return Ok(()) };
        if object.plugin() != PLUGIN {
            return Err(match object.class().supported().contains(&object.plugin()) {
                true => object
                    .error(format!("a `{}` can't stand inside a shape", object.plugin()))
                    .help(format!("move it into the scene; in shapes stands an `{PLUGIN}`")),
                false => object.unknown_plugin(),
            });
        }
        let sensor = build(object, self.description.shapes.len() as u32, &mut self.files)?;
        if self.sees {
            self.files.warnings.push(object.warning("the first sensor is used, this one is not"));
            return Ok(());
        }
        self.sees = true;
        self.description.sensor = sensor;
        match self.description.integrator {
            Integrator::Aov { .. } | Integrator::AmbientOcclusion { .. } => Err(object
                .error(format!("an `{PLUGIN}` measures light, of which this scene's integrator says nothing"))
                .help("use the integrator `path`")),
            Integrator::Path { hide_emitters: true, .. } | Integrator::Direct { hide_emitters: true } => {
                let message = "`hide_emitters` hides them from eyes: a meter counts what they send";
                self.files.warnings.push(object.warning(message));
                Ok(())
            }
            _ => Ok(()),
        }
    }
}
