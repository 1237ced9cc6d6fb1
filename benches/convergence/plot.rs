//! The picture: error over N, both logarithmic, and the line N^-½.

use std::{error::Error, path::Path};

use plotters::{element::DashedPathElement, prelude::*};

use crate::{COUNTS, Curve};

const SIZE: (u32, u32) = (760, 520);
const FONT: &str = "sans-serif";
const INK: RGBColor = RGBColor(40, 44, 52);
const GRID: RGBColor = RGBColor(226, 229, 234);
/// Colours that the colour-blind can tell apart (Okabe & Ito 2008).
const COLORS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(204, 121, 167)];

/// Draws the curves into an SVG.
pub(crate) fn draw(curves: &[Curve], path: &Path) -> Result<(), String> {
    drawn(curves, path).map_err(|error| format!("{}: {error}", path.display()))
}

fn drawn(curves: &[Curve], path: &Path) -> Result<(), Box<dyn Error>> {
    let area = SVGBackend::new(path, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let errors = || curves.iter().flat_map(|curve| &curve.points).map(|point| point.1);
    let (low, high) = (errors().fold(f64::MAX, f64::min), errors().fold(0.0, f64::max));
    let last = f64::from(COUNTS[COUNTS.len() - 1]);
    let decades = 10f64.powf(low.log10().floor())..10f64.powf(high.log10().ceil());
    let mut chart = ChartBuilder::on(&area)
        .caption("Relative error over samples a pixel", (FONT, 19).into_font().color(&INK))
        .margin(14)
        .margin_right(190)
        .x_label_area_size(30)
        .y_label_area_size(54)
        .build_cartesian_2d((0.9..last * 1.1).log_scale(), decades.log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(INK.stroke_width(1))
        .label_style((FONT, 13).into_font().color(&INK))
        .x_label_formatter(&|n| format!("{n}"))
        .y_label_formatter(&|y| format!("{y}"))
        .draw()?;
    let root = |n: f64| (n, high * n.powf(-0.5));
    chart.draw_series([DashedPathElement::new([root(1.0), root(last)], 5, 4, INK.stroke_width(1))])?;
    for (curve, color) in curves.iter().zip(COLORS) {
        chart.draw_series(LineSeries::new(curve.points.iter().copied(), color.stroke_width(2)))?;
        chart.draw_series(curve.points.iter().map(|&point| Circle::new(point, 3, color.filled())))?;
    }
    let text = |color: RGBColor| (FONT, 14).into_font().color(&color);
    let (left, mut top) = (SIZE.0 as i32 - 182, 60);
    for (curve, color) in curves.iter().zip(COLORS) {
        area.draw(&Text::new(format!("{}, N^{:.2}", curve.name, curve.slope()), (left, top), text(color)))?;
        top += 22;
    }
    area.draw(&Text::new("dashed: N^-0.50", (left, top), text(INK)))?;
    area.present()?;
    Ok(())
}
