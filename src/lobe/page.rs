//! The page of a material: polar slices, the lobe as a solid, the albedo over the angle, a lit sphere.

use glam::DVec3;
use kuva::{
    plot::LinePlot,
    render::{
        layout::Layout,
        plots::Plot,
        render::{Scene, render_multiple},
    },
};

use super::{
    Albedo, Curves, Drawing, Ink, Swatch,
    drawing::{Anchor, SCALE},
    polar::{Dial, INKS},
    portrait::{self, Exposure},
};
use crate::compile::CompileError;

const WIDTH: f64 = 1000.0;
const MARGIN: f64 = 28.0;
/// Side of the rendered pictures, in units of the page.
const SIDE: u32 = 340;
const TOP: f64 = 96.0;
const BELOW: f64 = 512.0;

/// What a page may vary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PageOptions {
    /// Angle of the light that the solid lobe is shown for, in degrees from the normal.
    pub light: f32,
    /// Are the polar slices logarithmic, over four decades?
    pub logarithmic: bool,
    /// Samples a pixel of the rendered pictures.
    pub samples: u32,
}

impl Default for PageOptions {
    fn default() -> Self {
        Self { light: 40.0, logarithmic: false, samples: 64 }
    }
}

/// Draws the page of a material called `title`, on the current rayon pool.
///
/// # Errors
/// [`CompileError`], as for a scene.
pub fn page(
    title: &str,
    swatch: &Swatch,
    curves: &Curves,
    options: PageOptions,
) -> Result<Drawing, CompileError> {
    let mut drawing = Drawing::new(WIDTH, BELOW + f64::from(SIDE) + 2.0 * MARGIN);
    drawing.text((MARGIN, 44.0), 22, Anchor::Start, Ink::TEXT, title);
    let right = WIDTH - MARGIN - f64::from(SIDE);

    let radius = if options.logarithmic { "f cos θₒ, four decades" } else { "f cos θₒ per steradian" };
    drawing.text((MARGIN, TOP - 16.0), 14, Anchor::Start, Ink::TEXT, &format!("Slices: {radius}"));
    let whole = swatch.transmits();
    let center = (MARGIN + 275.0, TOP + if whole { 172.0 } else { 290.0 });
    let dial =
        Dial { center, radius: if whole { 150.0 } else { 255.0 }, whole, logarithmic: options.logarithmic };
    dial.draw(&mut drawing, &curves.slices);
    legend(&mut drawing, curves, TOP + 354.0);

    let exposure = Exposure { side: SIDE * SCALE, samples: options.samples };
    let solid = format!("The lobe of light from {}°", options.light);
    drawing.text((right, TOP - 16.0), 14, Anchor::Start, Ink::TEXT, &solid);
    drawing.picture((right, TOP), portrait::lobe(swatch, options.light, exposure)?);

    drawing.text((MARGIN, BELOW - 16.0), 14, Anchor::Start, Ink::TEXT, "Albedo, seen from an angle");
    albedo_legend(&mut drawing, &curves.albedo, BELOW - 16.0);
    drawing.chart((MARGIN - 10.0, BELOW - 6.0), albedo_chart(&curves.albedo));
    drawing.text((right, BELOW - 16.0), 14, Anchor::Start, Ink::TEXT, "A lit sphere");
    drawing.picture((right, BELOW), portrait::sphere(swatch.material(), exposure)?);
    Ok(drawing)
}

fn legend(drawing: &mut Drawing, curves: &Curves, y: f64) {
    drawing.text((MARGIN, y), 12, Anchor::Start, Ink::FAINT, "light from");
    let mut x = MARGIN + 78.0;
    for (slice, ink) in curves.slices.iter().zip(INKS) {
        drawing.line(vec![(x, y - 4.0), (x + 22.0, y - 4.0)], ink, 2.4, None);
        drawing.text((x + 28.0, y), 12, Anchor::Start, Ink::TEXT, &format!("{}°", slice.light));
        x += 68.0;
    }
    if curves.slices.iter().any(|slice| !slice.spikes.is_empty()) {
        drawing.line(vec![(x, y - 4.0), (x + 22.0, y - 4.0)], Ink::FAINT, 1.8, Some("6 4"));
        drawing.text((x + 28.0, y), 12, Anchor::Start, Ink::TEXT, "mirror: share, rim 1");
    }
}

/// The colours of red, green, blue, and of all three where they are one.
const CHANNELS: [(&str, &str, Ink); 4] = [
    ("red", "#c8321e", Ink(200, 50, 30)),
    ("green", "#2c9340", Ink(44, 147, 64)),
    ("blue", "#2f62c4", Ink(47, 98, 196)),
    ("all channels", "#282c34", Ink::TEXT),
];

/// The channels that are told apart.
fn channels(albedo: &[Albedo]) -> &'static [(&'static str, &'static str, Ink)] {
    let grey = |rgb: DVec3| (rgb.max_element() - rgb.min_element()) < 1e-3;
    let all = albedo.iter().all(|albedo| grey(albedo.reflected) && grey(albedo.transmitted));
    if all { &CHANNELS[3..] } else { &CHANNELS[..3] }
}

fn passes(albedo: &[Albedo]) -> bool {
    albedo.iter().any(|albedo| albedo.transmitted.max_element() > 0.0)
}

fn albedo_legend(drawing: &mut Drawing, albedo: &[Albedo], y: f64) {
    let mut x = MARGIN + 220.0;
    let mut entry = |ink: Ink, width: f64, text: &str| {
        drawing.line(vec![(x, y - 4.0), (x + 22.0, y - 4.0)], ink, width, None);
        drawing.text((x + 28.0, y), 12, Anchor::Start, Ink::TEXT, text);
        x += 46.0 + 7.2 * text.len() as f64;
    };
    for &(name, _, ink) in channels(albedo) {
        entry(ink, BOLD, name);
    }
    if passes(albedo) {
        entry(Ink::FAINT, THIN, "let through");
    }
}

const BOLD: f64 = 2.4;
const THIN: f64 = 1.0;

/// One line a channel; a thin one for what passes through.
fn albedo_chart(albedo: &[Albedo]) -> Scene {
    let mut plots = Vec::new();
    let mut line = |value: &dyn Fn(&Albedo) -> f64, color: &str, width: f64| {
        let points = albedo.iter().map(|albedo| (f64::from(albedo.angle), value(albedo)));
        plots.push(Plot::Line(LinePlot::new().with_data(points).with_color(color).with_stroke_width(width)));
    };
    for (k, (_, color, _)) in channels(albedo).iter().enumerate() {
        line(&|albedo| albedo.reflected[k], color, BOLD);
        if passes(albedo) {
            line(&|albedo| albedo.transmitted[k], color, THIN);
        }
    }
    let highest = albedo.iter().map(|a| a.reflected.max(a.transmitted).max_element()).fold(1.0, f64::max);
    // Above 1 there is something to be seen.
    let top = if highest > 1.005 { highest } else { 1.0 };
    let layout = Layout::new((0.0, 90.0), (0.0, top))
        .with_width(590.0)
        .with_height(f64::from(SIDE) + 20.0)
        .with_x_label("degrees from the normal")
        .with_x_axis_min(0.0)
        .with_x_axis_max(90.0)
        .with_x_tick_step(15.0)
        .with_y_axis_min(0.0)
        .with_y_axis_max(top)
        .with_label_size(12)
        .with_tick_size(11)
        .with_body_size(11);
    render_multiple(plots, layout)
}
