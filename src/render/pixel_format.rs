//! Colours to the channels that the film asks for.

use super::{Rendered, Settings, alpha::Alpha, render_with};
use crate::compile::Scene;
use crate::picture::{Channel, Picture};
use crate::scene::PixelFormat;

/// Y of linear sRGB.
const LUMINANCE: [f32; 3] = [0.212_671, 0.715_16, 0.072_169];

/// A rendered picture in the film's format. One without `R G B` stays as it is.
pub(super) fn formatted(scene: &Scene, settings: &Settings, mut rendered: Rendered) -> Rendered {
    let Some(luminance) = luminance(&rendered.picture) else { return rendered };
    let format = scene.film.format;
    if matches!(format, PixelFormat::Luminance | PixelFormat::LuminanceAlpha) {
        rendered.picture.channels = vec![Channel { name: "Y".into(), samples: luminance }];
    }
    // What a meter sees from a surface has no holes to look through.
    if matches!(format, PixelFormat::Rgba | PixelFormat::LuminanceAlpha) && !scene.has_meter() {
        let alpha = render_with(scene, &Alpha::of(scene), settings, &|_| {});
        rendered.picture.channels.extend(alpha.picture.channels);
        rendered.statistics.camera_rays += alpha.statistics.camera_rays;
        rendered.statistics.time += alpha.statistics.time;
    }
    rendered
}

fn luminance(picture: &Picture) -> Option<Vec<f32>> {
    let [r, g, b] = [picture.plane("R")?, picture.plane("G")?, picture.plane("B")?];
    let [in_red, in_green, in_blue] = LUMINANCE;
    Some(r.iter().zip(g).zip(b).map(|((r, g), b)| in_red * r + in_green * g + in_blue * b).collect())
}
