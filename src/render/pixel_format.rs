//! Colours to the channels that the film asks for.

use super::{Rendered, Settings, alpha::Alpha, render_with};
use crate::compile::Scene;
use crate::picture::{Channel, Picture};
use crate::scene::PixelFormat;

/// Y of linear sRGB.
const LUMINANCE: [f32; 3] = [0.212_671, 0.715_16, 0.072_169];

impl Rendered {
    /// The same in the film's format. A picture without `R G B` stays as it is, and so do other channels.
    ///
    /// Alpha takes a render of camera rays, on the current rayon pool.
    #[must_use]
    pub fn formatted(mut self, scene: &Scene, settings: &Settings) -> Self {
        let format = scene.film.format;
        if !["R", "G", "B"].iter().all(|name| self.picture.plane(name).is_some()) {
            return self;
        }
        let grey = matches!(format, PixelFormat::Luminance | PixelFormat::LuminanceAlpha);
        let luminance = if grey { luminance(&self.picture) } else { None };
        let channels = &mut self.picture.channels;
        if let Some(luminance) = luminance {
            channels.retain(|channel| !["R", "G", "B"].contains(&channel.name.as_str()));
            channels.insert(0, Channel { name: "Y".into(), samples: luminance });
        }
        // What a meter sees from a surface has no holes to look through.
        if matches!(format, PixelFormat::Rgba | PixelFormat::LuminanceAlpha) && !scene.has_meter() {
            let alpha = render_with(scene, &Alpha::of(scene), settings, &|_| {});
            channels.extend(alpha.picture.channels.into_iter().filter(|channel| channel.name == "A"));
            self.statistics.camera_rays += alpha.statistics.camera_rays;
            self.statistics.time += alpha.statistics.time;
        }
        self
    }
}

fn luminance(picture: &Picture) -> Option<Vec<f32>> {
    let [r, g, b] = [picture.plane("R")?, picture.plane("G")?, picture.plane("B")?];
    let [in_red, in_green, in_blue] = LUMINANCE;
    Some(r.iter().zip(g).zip(b).map(|((r, g), b)| in_red * r + in_green * g + in_blue * b).collect())
}
