//! The picture of growth: four panels over the number of triangles, on a logarithmic axis.

use std::{error::Error, path::Path};

use plotters::{
    coord::{
        Shift,
        combinators::LogCoord,
        ranged1d::{Ranged, ValueFormatter},
    },
    element::DashedPathElement,
    prelude::*,
};

use crate::{
    growth::KINDS,
    row::{BUILD, Row, Table},
    tables::{groups, points},
};

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Points = Vec<(f64, f64)>;

const SIZE: (u32, u32) = (960, 760);
const HEAD: u32 = 76;
const FONT: &str = "sans-serif";
const INK: RGBColor = RGBColor(40, 44, 52);
const GRID: RGBColor = RGBColor(226, 229, 234);
/// Blue, orange and green that the colour-blind can tell apart (Okabe & Ito 2008).
const COLORS: [RGBColor; 3] = [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115)];

/// A quantity against N: of rays that bounced and rays of the camera (dashed), or of builds.
struct Panel {
    title: &'static str,
    classes: &'static [&'static str],
    quantity: fn(&Row) -> Option<f64>,
    logarithmic: bool,
}

const RAYS: [&str; 2] = ["diffuse", "primary"];
const PANELS: [Panel; 4] = [
    Panel {
        title: "Nodes, one ray at a time",
        classes: &RAYS,
        quantity: |row| row.single_nodes_per_ray,
        logarithmic: false,
    },
    Panel {
        title: "Mrays/s on one thread",
        classes: &RAYS,
        quantity: |row| row.mega_per_s,
        logarithmic: true,
    },
    Panel { title: "Build, Mtris/s", classes: &[BUILD], quantity: |row| row.mega_per_s, logarithmic: false },
    Panel {
        title: "Bytes a triangle",
        classes: &[BUILD],
        quantity: |row| row.bytes_per_primitive,
        logarithmic: false,
    },
];

/// Draws the first group of a record that has growth in it; without any, nothing is drawn.
pub(crate) fn draw(rows: &[Row], path: &Path) -> Result<bool, String> {
    let groups = groups(rows, Table::Growth);
    let Some(group) = groups.iter().find(|group| group.iter().any(|row| row.class == BUILD)) else {
        return Ok(false);
    };
    drawn(group, path).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(true)
}

fn drawn(group: &[&Row], path: &Path) -> Result<(), Box<dyn Error>> {
    let area = SVGBackend::new(path, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let (head, rest) = area.split_vertically(HEAD);
    title(&head, group)?;
    for (panel, area) in PANELS.iter().zip(rest.split_evenly((2, 2))) {
        panel.draw(&area, group)?;
    }
    area.present()?;
    Ok(())
}

fn title(area: &Area, group: &[&Row]) -> Result<(), Box<dyn Error>> {
    let row = group[0];
    let text = |size: i32| (FONT, size).into_font().color(&INK);
    let said = format!("What a tree costs as it grows: {}, {}, {}", row.cpu, row.lanes, row.date);
    area.draw(&Text::new(said, (24, 14), text(19)))?;
    let mut x = 24;
    let mut say = |what: String, width: i32| {
        area.draw(&Text::new(what, (x + 33, 45), text(14)))?;
        x += width;
        Ok::<_, Box<dyn Error>>([(x - width, 53), (x - width + 26, 53)])
    };
    for (kind, color) in KINDS.iter().zip(COLORS) {
        let [left, right] = say(format!("gen:{kind}"), 130)?;
        area.draw(&PathElement::new([left, right], color.stroke_width(2)))?;
        area.draw(&Circle::new((left.0 + 13, left.1), 3, color.filled()))?;
    }
    area.draw(&DashedPathElement::new(say("camera rays".into(), 150)?, 5, 4, INK.stroke_width(2)))?;
    let build = group.iter().find(|row| row.class == BUILD).map_or(1, |row| row.threads);
    let threads = if build == 1 { "1 thread".to_owned() } else { format!("{build} threads") };
    area.draw(&PathElement::new(say(format!("bounced rays; builds on {threads}"), 0)?, INK.stroke_width(2)))?;
    Ok(())
}

/// Points of a class, kind by kind.
type Lines = Vec<(&'static str, [Points; 3])>;

impl Panel {
    fn draw(&self, area: &Area, group: &[&Row]) -> Result<(), Box<dyn Error>> {
        let of = |class: &str| KINDS.map(|kind| points(group, kind, class, self.quantity));
        let lines: Lines = self.classes.iter().map(|&class| (class, of(class))).collect();
        let all = || lines.iter().flat_map(|(_, kinds)| kinds.iter().flatten());
        let extent = |of: fn(&(f64, f64)) -> f64| {
            all().map(of).fold((f64::MAX, 0.0f64), |(low, high), x| (low.min(x), high.max(x)))
        };
        let ((left, right), (bottom, top)) = (extent(|p| p.0), extent(|p| p.1));
        if top <= 0.0 {
            return Ok(());
        }
        let mut chart = ChartBuilder::on(area);
        chart
            .caption(self.title, (FONT, 16).into_font().color(&INK))
            .margin(10)
            .margin_right(24)
            .x_label_area_size(28)
            .y_label_area_size(46);
        let x = (left * 0.8..right * 1.25).log_scale();
        if self.logarithmic {
            // Whole decades, so that the axis has labels.
            let decades = 10f64.powf(bottom.log10().floor())..10f64.powf(top.log10().ceil());
            fill(chart.build_cartesian_2d(x, decades.log_scale())?, lines)
        } else {
            fill(chart.build_cartesian_2d(x, 0.0..top * 1.08)?, lines)
        }
    }
}

type Chart<'a, 'b, Y> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, Y>>;

/// Axes and lines.
fn fill<Y>(mut chart: Chart<Y>, lines: Lines) -> Result<(), Box<dyn Error>>
where
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(INK.stroke_width(1))
        .label_style((FONT, 13).into_font().color(&INK))
        .x_labels(5)
        .y_labels(6)
        .x_label_formatter(&|n| short(*n))
        .y_label_formatter(&|y| format!("{y}"))
        .draw()?;
    for (class, kinds) in lines {
        for (points, color) in kinds.into_iter().zip(COLORS) {
            let dots: Vec<_> = points.iter().map(|&point| Circle::new(point, 3, color.filled())).collect();
            if class == "primary" {
                chart.draw_series(DashedLineSeries::new(points, 5, 4, color.stroke_width(2)))?;
            } else {
                chart.draw_series(LineSeries::new(points, color.stroke_width(2)))?;
            }
            chart.draw_series(dots)?;
        }
    }
    Ok(())
}

/// `1k`, `10M`.
fn short(n: f64) -> String {
    if n >= 1e6 {
        format!("{}M", n / 1e6)
    } else if n >= 1e3 {
        format!("{}k", n / 1e3)
    } else {
        format!("{n}")
    }
}
