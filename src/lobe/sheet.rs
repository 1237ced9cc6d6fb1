//! A contact sheet: one lit sphere a material, as Matusik printed his measurements \[MPB03\].

use super::{
    Drawing, Ink,
    drawing::{Anchor, SCALE},
    portrait::{self, Exposure},
};
use crate::{compile::CompileError, scene::Material};

const COLUMNS: usize = 5;
/// Side of a sphere's picture, in units of the page.
const SIDE: u32 = 168;
const GAP: f64 = 14.0;
const CAPTION: f64 = 42.0;
const MARGIN: f64 = 26.0;
const TOP: f64 = 72.0;

/// A material on the sheet.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Its model.
    pub name: String,
    /// What is particular about it.
    pub caption: String,
    /// The material.
    pub material: Material,
}

/// Draws the cells row by row, five a row, with so many samples a pixel, on the current rayon pool.
///
/// # Errors
/// [`CompileError`], as for a scene.
pub fn sheet(title: &str, cells: &[Cell], samples: u32) -> Result<Drawing, CompileError> {
    let side = f64::from(SIDE);
    let place = |n: usize, step: f64| n as f64 * step;
    let rows = cells.len().div_ceil(COLUMNS);
    let width = 2.0 * MARGIN + place(COLUMNS, side + GAP) - GAP;
    let mut drawing = Drawing::new(width, TOP + place(rows, side + CAPTION) + MARGIN - GAP);
    drawing.text((MARGIN, 44.0), 20, Anchor::Start, Ink::TEXT, title);
    for (i, cell) in cells.iter().enumerate() {
        let x = MARGIN + place(i % COLUMNS, side + GAP);
        let y = TOP + place(i / COLUMNS, side + CAPTION);
        let exposure = Exposure { side: SIDE * SCALE, samples };
        drawing.picture((x, y), portrait::sphere(&cell.material, exposure)?);
        drawing.text((x, y + side + 15.0), 13, Anchor::Start, Ink::TEXT, &cell.name);
        drawing.text((x, y + side + 29.0), 10, Anchor::Start, Ink::FAINT, &cell.caption);
    }
    Ok(drawing)
}
