//! `--crop`: a part of the picture.

use crate::scene::{Crop, Film};

/// Columns and rows, from the first to the one behind the last, in pixels of the whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Bounds {
    columns: [u32; 2],
    rows: [u32; 2],
}

/// For clap: four whole numbers, in the order in which pbrt has them.
pub(super) fn parse(argument: &str) -> Result<Bounds, String> {
    let numbers: Option<Vec<u32>> = argument.split(',').map(|number| number.trim().parse().ok()).collect();
    let bounds = match numbers.as_deref() {
        Some(&[x0, x1, y0, y1]) => Bounds { columns: [x0, x1], rows: [y0, y1] },
        _ => return Err("expected four pixel positions x0,x1,y0,y1, as in --crop 100,200,0,50".into()),
    };
    for (name, [first, end]) in [("x", bounds.columns), ("y", bounds.rows)] {
        if first >= end {
            return Err(format!(
                "{name}0 is {first} and {name}1 is {end}: from {name}0 up to, and without, {name}1"
            ));
        }
    }
    Ok(bounds)
}

impl Bounds {
    /// As a crop of a film, in place of the one it has.
    ///
    /// # Errors
    /// A sentence, if it reaches beyond the film.
    pub(super) fn of(self, film: &Film) -> Result<Crop, String> {
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
    fn nothing_is_outside_of_the_film() {
        let bounds = parse("0,5,0,5").unwrap();
        assert!(bounds.of(&Film::new(5, 5)).is_ok());
        assert!(bounds.of(&Film::new(4, 5)).is_err() && bounds.of(&Film::new(5, 4)).is_err());
    }
}
