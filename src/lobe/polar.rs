//! The polar plot: f |cos θ_o| in the plane of incidence, for several angles of the light.

use super::{
    curves::Slice,
    drawing::{Anchor, Drawing, Ink},
    solid::luminance,
};

/// From violet to orange, in the order of angles: also told apart by their lightness alone.
pub(super) const INKS: [Ink; 5] =
    [Ink(68, 1, 84), Ink(59, 82, 139), Ink(33, 145, 140), Ink(94, 201, 98), Ink(240, 145, 5)];

/// Decades between the rim and the middle of a logarithmic plot.
const DECADES: f64 = 4.0;

/// Where the plot stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dial {
    /// The point of the surface.
    pub(super) center: (f64, f64),
    /// Of the rim.
    pub(super) radius: f64,
    /// Are both sides of the surface shown?
    pub(super) whole: bool,
    /// Is the radius the logarithm of the value?
    pub(super) logarithmic: bool,
}

impl Dial {
    /// Draws all slices on one dial.
    pub(super) fn draw(&self, drawing: &mut Drawing, slices: &[Slice]) {
        let values = slices.iter().flat_map(|slice| &slice.points).map(|(_, rgb)| f64::from(luminance(*rgb)));
        let brightest = values.fold(0.0, f64::max);
        let rim = if self.logarithmic { 10f64.powf(brightest.log10().ceil()) } else { round_up(brightest) };
        self.grid(drawing, (brightest > 0.0).then_some(rim));
        for (slice, ink) in slices.iter().zip(INKS).rev() {
            self.slice(drawing, slice, ink, rim);
        }
        for (slice, ink) in slices.iter().zip(INKS) {
            self.arrow(drawing, slice.light, ink);
        }
    }

    fn at(&self, degrees: f64, part: f64) -> (f64, f64) {
        let (sin, cos) = degrees.to_radians().sin_cos();
        (self.center.0 + self.radius * part * sin, self.center.1 - self.radius * part * cos)
    }

    fn part(&self, value: f64, rim: f64) -> f64 {
        if self.logarithmic { (1.0 + (value / rim).log10() / DECADES).max(0.0) } else { value / rim }
    }

    fn grid(&self, drawing: &mut Drawing, rim: Option<f64>) {
        let most: i32 = if self.whole { 180 } else { 90 };
        let arc =
            |part: f64| (-most..=most).step_by(2).map(|degrees| self.at(f64::from(degrees), part)).collect();
        for ring in 1..=4 {
            let part = f64::from(ring) / 4.0;
            drawing.line(arc(part), Ink::GRID, 1.0, None);
            let value =
                rim.map(
                    |rim| {
                        if self.logarithmic { rim * 10f64.powf(DECADES * (part - 1.0)) } else { rim * part }
                    },
                );
            let (x, y) = self.at(90.0, part);
            let text = value.map_or(String::new(), short);
            drawing.text((x, y + 15.0), 11, Anchor::Middle, Ink::FAINT, &text);
        }
        for degrees in (-most..=most).step_by(30).filter(|degrees| degrees.abs() < 180 || *degrees > 0) {
            let degrees = f64::from(degrees);
            drawing.line(vec![self.center, self.at(degrees, 1.0)], Ink::GRID, 1.0, None);
            let (x, y) = self.at(degrees, 1.08);
            // The light comes from the left: its wedges stand where labels would.
            if degrees >= 0.0 && degrees != 90.0 {
                drawing.text((x, y + 4.0), 11, Anchor::Middle, Ink::FAINT, &format!("{degrees}°"));
            }
        }
        drawing.line(vec![self.at(-90.0, 1.0), self.at(90.0, 1.0)], Ink::TEXT, 1.4, None);
    }

    fn slice(&self, drawing: &mut Drawing, slice: &Slice, ink: Ink, rim: f64) {
        let point = |&(angle, rgb): &(f32, glam::Vec3)| {
            self.at(f64::from(angle), self.part(f64::from(luminance(rgb)), rim))
        };
        let curve: Vec<_> = slice.points.iter().map(point).collect();
        if slice.points.iter().any(|(_, rgb)| luminance(*rgb) > 0.0) {
            drawing.area(&curve, ink, 0.07);
            drawing.line(curve, ink, 1.8, None);
        }
        for spike in &slice.spikes {
            let tip = self.at(f64::from(spike.angle), f64::from(luminance(spike.share)));
            drawing.line(vec![self.center, tip], ink, 1.8, Some("6 4"));
            drawing.dot(tip, 3.5, ink);
        }
    }

    /// A wedge on the rim that points the way the light comes.
    fn arrow(&self, drawing: &mut Drawing, light: f32, ink: Ink) {
        let degrees = -f64::from(light);
        let corners = [self.at(degrees, 0.94), self.at(degrees - 1.9, 1.03), self.at(degrees + 1.9, 1.03)];
        drawing.area(&corners, ink, 1.0);
    }
}

/// The next of 1, 1.2, 1.6, 2, 2.4, 3.2, 4, 6, 8 × 10ⁿ: a quarter of it is a short number.
fn round_up(value: f64) -> f64 {
    let decade = 10f64.powf(value.max(1e-12).log10().floor());
    let steps = [1.0, 1.2, 1.6, 2.0, 2.4, 3.2, 4.0, 6.0, 8.0, 10.0];
    steps.into_iter().map(|step| step * decade).find(|rim| *rim >= value).unwrap_or(10.0 * decade)
}

/// Three digits, without what says nothing.
fn short(value: f64) -> String {
    if (1e-3..1e4).contains(&value) {
        let digits = (2 - value.log10().floor() as i32).max(0) as usize;
        let text = format!("{value:.digits$}");
        let text = if digits > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        return text.to_owned();
    }
    format!("{value:.0e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rims_are_short_numbers() {
        for (value, rim) in [(0.31, 0.32), (1.0, 1.0), (9.0, 10.0), (130.0, 160.0), (0.0012, 0.0012)] {
            assert!((round_up(value) - rim).abs() < 1e-9 * rim, "{value}: {}", round_up(value));
        }
        for (value, text) in [(0.08, "0.08"), (0.6, "0.6"), (120.0, "120"), (2500.0, "2500"), (1e-5, "1e-5")]
        {
            assert_eq!(short(value), text);
        }
    }
}
