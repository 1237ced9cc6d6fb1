//! Colours to the channels that the film asks for.

use super::{Rendered, Settings, alpha::Alpha, render_with};
use crate::compile::Scene;
use crate::picture::{Channel, Picture};
use crate::scene::PixelFormat;

/// Y of linear sRGB.
const LUMINANCE: [f32; 3] = [0.212_671, 0.715_16, 0.072_169];

impl Rendered {
    /// The same in the film's format: [`with_alpha`](Self::with_alpha), then [`recoloured`](Self::recoloured).
    #[must_use]
    pub fn formatted(self, scene: &Scene, settings: &Settings) -> Self {
        self.with_alpha(scene, settings).recoloured(scene.film.format)
    }

    /// The same and `A`, if the film's format has it. A picture without `R G B` stays as it is.
    ///
    /// It takes a render of camera rays, on the current rayon pool.
    #[must_use]
    pub fn with_alpha(mut self, scene: &Scene, settings: &Settings) -> Self {
        let asked = matches!(scene.film.format, PixelFormat::Rgba | PixelFormat::LuminanceAlpha);
        // What a meter sees from a surface has no holes to look through.
        if asked && !scene.has_meter() && has_colours(&self.picture) {
            let alpha = render_with(scene, &Alpha::of(scene), settings, &|_| {});
            let alone = alpha.picture.channels.into_iter().filter(|channel| channel.name == "A");
            self.picture.channels.extend(alone);
            self.statistics.camera_rays += alpha.statistics.camera_rays;
            self.statistics.time += alpha.statistics.time;
        }
        self
    }

    /// `Y` in place of `R G B`, if the format has it. Other channels stay as they are, and so does a picture without
    /// colours.
    #[must_use]
    pub fn recoloured(mut self, format: PixelFormat) -> Self {
        let grey = matches!(format, PixelFormat::Luminance | PixelFormat::LuminanceAlpha);
        if let Some(samples) = grey.then(|| luminance(&self.picture)).flatten() {
            let channels = &mut self.picture.channels;
            channels.retain(|channel| !COLOURS.contains(&channel.name.as_str()));
            channels.insert(0, Channel { name: "Y".into(), samples });
        }
        self
    }
}

const COLOURS: [&str; 3] = ["R", "G", "B"];

fn has_colours(picture: &Picture) -> bool {
    COLOURS.iter().all(|name| picture.plane(name).is_some())
}

fn luminance(picture: &Picture) -> Option<Vec<f32>> {
    let [r, g, b] = [picture.plane("R")?, picture.plane("G")?, picture.plane("B")?];
    let [in_red, in_green, in_blue] = LUMINANCE;
    Some(r.iter().zip(g).zip(b).map(|((r, g), b)| in_red * r + in_green * g + in_blue * b).collect())
}
