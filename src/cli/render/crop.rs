//! `--crop` and `--cropwindow`: a part of the picture.

use std::{fmt::Display, str::FromStr};

use clap::Args;

use crate::scene::{Crop, Film};

/// The options.
#[derive(Clone, Debug, Args)]
pub(super) struct CropOptions {
    /// Only these columns and rows of the picture: from x0 up to, and without, x1
    ///
    /// In pixels of the whole picture, in place of the scene's own crop. Pixels are to the bit what they are in
    /// the whole; but tiles begin at the crop, so by --target-error others of them may be done.
    #[arg(long, visible_alias = "pixelbounds", value_name = "x0,x1,y0,y1", allow_hyphen_values = true, conflicts_with = "pixel", value_parser = parse)]
    crop: Option<Bounds>,

    /// The same in shares of the width and height, as in 0.5,1,0,0.5 for the upper right quarter
    ///
    /// Shares are rounded up to whole pixels, as pbrt does: windows that share an edge share no pixel.
    #[arg(long, value_name = "x0,x1,y0,y1", allow_hyphen_values = true, conflicts_with_all = ["pixel", "crop"], value_parser = parse_window)]
    cropwindow: Option<Window>,
}

impl CropOptions {
    /// As a crop of a film, if any is asked for.
    ///
    /// # Errors
    /// A sentence, if it reaches beyond the film, or is less than a pixel of it.
    pub(super) fn of(&self, film: &Film) -> Result<Option<Crop>, String> {
        let bounds = match (self.crop, self.cropwindow) {
            (Some(bounds), _) => bounds,
            (None, Some(window)) => window.bounds(film)?,
            (None, None) => return Ok(None),
        };
        bounds.of(film).map(Some)
    }
}

/// Columns and rows, from the first to the one behind the last, in pixels of the whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Bounds {
    columns: [u32; 2],
    rows: [u32; 2],
}

/// For clap: four whole numbers, in the order in which pbrt has them.
fn parse(argument: &str) -> Result<Bounds, String> {
    let [x0, x1, y0, y1] = four(argument).ok_or_else(|| {
        let meant =
            if four::<f32>(argument).is_some() { "; shares of the size go to --cropwindow" } else { "" };
        format!("expected four pixel positions x0,x1,y0,y1, as in --crop 100,200,0,50{meant}")
    })?;
    let (columns, rows) = ([x0, x1], [y0, y1]);
    rising(columns, rows)?;
    Ok(Bounds { columns, rows })
}

/// Columns and rows in shares of a film's width and height.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Window {
    columns: [f32; 2],
    rows: [f32; 2],
}

/// For clap: four shares from 0 to 1.
fn parse_window(argument: &str) -> Result<Window, String> {
    let shares = four(argument).filter(|shares| shares.iter().all(|share| (0.0..=1.0).contains(share)));
    let [x0, x1, y0, y1] = shares.ok_or(
        "expected four shares x0,x1,y0,y1 from 0 to 1, as in --cropwindow 0.5,1,0,0.5; pixels go to --crop",
    )?;
    let (columns, rows) = ([x0, x1], [y0, y1]);
    rising(columns, rows)?;
    Ok(Window { columns, rows })
}

fn four<T: FromStr>(argument: &str) -> Option<[T; 4]> {
    let numbers: Option<Vec<T>> = argument.split(',').map(|number| number.trim().parse().ok()).collect();
    numbers?.try_into().ok()
}

fn rising<T: PartialOrd + Display>(columns: [T; 2], rows: [T; 2]) -> Result<(), String> {
    for (name, [first, end]) in [("x", columns), ("y", rows)] {
        if first >= end {
            return Err(format!(
                "{name}0 is {first} and {name}1 is {end}: from {name}0 up to, and without, {name}1"
            ));
        }
    }
    Ok(())
}

impl Window {
    /// In pixels of a film.
    fn bounds(self, film: &Film) -> Result<Bounds, String> {
        // Single precision, for pbrt's pixels.
        let pixels =
            |shares: [f32; 2], length: u32| shares.map(|share| (share * length as f32).ceil() as u32);
        let Film { width, height, .. } = *film;
        let bounds = Bounds { columns: pixels(self.columns, width), rows: pixels(self.rows, height) };
        if bounds.columns[0] == bounds.columns[1] || bounds.rows[0] == bounds.rows[1] {
            let Self { columns: [x0, x1], rows: [y0, y1] } = self;
            return Err(format!(
                "--cropwindow {x0},{x1},{y0},{y1} has no pixel of a picture of {width} x {height}: make it wider, or \
                 name pixels by --crop"
            ));
        }
        Ok(bounds)
    }
}

impl Bounds {
    /// As a crop of a film, in place of the one it has.
    ///
    /// # Errors
    /// A sentence, if it reaches beyond the film.
    fn of(self, film: &Film) -> Result<Crop, String> {
        let Self { columns: [x, right], rows: [y, bottom] } = self;
        let Film { width, height, .. } = *film;
        if right > width || bottom > height {
            return Err(format!(
                "--crop ends at ({right}, {bottom}), outside of the picture, which has {width} x {height} pixels"
            ));
        }
        Ok(Crop { x, y, width: right - x, height: bottom - y })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_numbers_are_columns_and_then_rows() {
        let crop = parse("1,4, 2,9").unwrap().of(&Film::new(4, 9));
        assert_eq!(crop, Ok(Crop { x: 1, y: 2, width: 3, height: 7 }));
        for wrong in ["", "1,2,3", "1,2,3,4,5", "0,1,0,0.5", "-1,2,3,4", "4,4,0,1", "0,1,5,3"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn shares_are_rounded_up() {
        let bounds = |window: &str, width, height| {
            let Bounds { columns: [x0, x1], rows: [y0, y1] } =
                parse_window(window).unwrap().bounds(&Film::new(width, height))?;
            Ok::<_, String>([x0, x1, y0, y1])
        };
        assert_eq!(bounds("0,1,0,1", 640, 480), Ok([0, 640, 0, 480]));
        assert_eq!(bounds("0.5,1, 0,0.5", 7, 5), Ok([4, 7, 0, 3]));
        // Neighbours meet: no pixel is in both, and none in neither.
        assert_eq!(bounds("0,0.5,0.5,1", 7, 5), Ok([0, 4, 3, 5]));
        assert!(bounds("0.51,0.52,0,1", 10, 10).unwrap_err().contains("no pixel of a picture of 10 x 10"));
        for wrong in
            ["", "0,1,0", "0,1,0,1,1", "0,2,0,1", "-0.1,1,0,1", "0,NaN,0,1", "1,1,0,1", "0,1,0.6,0.3"]
        {
            assert!(parse_window(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn nothing_is_outside_of_the_film() {
        let bounds = parse("0,5,0,5").unwrap();
        assert!(bounds.of(&Film::new(5, 5)).is_ok());
        assert!(bounds.of(&Film::new(4, 5)).is_err() && bounds.of(&Film::new(5, 4)).is_err());
    }
}
