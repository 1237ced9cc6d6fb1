//! The lobe of a material as a solid.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::{Swatch, curves::radiant_intensity};
use crate::{
    math::Frame,
    picture::{Channel, Picture},
    scene::Mesh,
    simd::{LANES, Vec3x8, Vector3, vector3},
};

/// Rows from the brightest direction to the opposite one, and columns about it.
const ROWS: usize = 160;
const COLUMNS: usize = 180;

/// A surface about the origin, at the distance f |cos θ_o| in each direction, of which the greatest is 1.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    pub(super) mesh: Mesh,
    /// The hue of the light, over the uv of the mesh.
    pub(super) colors: Picture,
}

impl Solid {
    /// For light from a direction; `None` if all of it goes into single directions.
    pub(super) fn new(swatch: &Swatch, to_light: Vec3) -> Option<Self> {
        // The brightest direction may be a refracted one: what a first look finds is the axis of the second.
        let first = directions(Vec3::new(-to_light.x, -to_light.y, to_light.z));
        let found = first.iter().zip(values(swatch, to_light, &first));
        let (axis, _) = found.max_by(|a, b| luminance(a.1).total_cmp(&luminance(b.1)))?;
        let directions = directions(*axis);
        let values = values(swatch, to_light, &directions);
        let brightest = values.iter().copied().map(luminance).fold(0.0, f32::max);
        if brightest <= 0.0 {
            return None;
        }
        let position = |(w, value): (&Vec3, &Vec3)| *w * (luminance(*value) / brightest);
        let uv = |i: usize| {
            Vec2::new((i % COLUMNS) as f32 / (COLUMNS - 1) as f32, (i / COLUMNS) as f32 / (ROWS - 1) as f32)
        };
        let corner = |row: usize, column: usize| (row * COLUMNS + column) as u32;
        let cells = (0..ROWS - 1).flat_map(|row| (0..COLUMNS - 1).map(move |column| (row, column)));
        let triangles = cells.flat_map(|(row, column)| {
            let [a, b] = [corner(row, column), corner(row, column + 1)];
            let [c, d] = [corner(row + 1, column), corner(row + 1, column + 1)];
            [[a, c, b], [b, c, d]]
        });
        let mesh = Mesh {
            positions: directions.iter().zip(&values).map(position).collect(),
            normals: Vec::new(),
            uvs: (0..values.len()).map(uv).collect(),
            attributes: vec![],
            triangles: triangles.collect(),
        };
        Some(Self { mesh, colors: hues(&values) })
    }
}

/// What leaves in each direction.
fn values(swatch: &Swatch, to_light: Vec3, directions: &[Vec3]) -> Vec<Vec3> {
    let some = directions.chunks(LANES).flat_map(|some| {
        let wo = Vec3x8::from_fn(|i| some[i.min(some.len() - 1)]);
        let light = radiant_intensity(swatch, Vec3x8::splat(to_light), wo);
        (0..some.len()).map(move |i| light.lane(i))
    });
    some.collect()
}

/// A grid about an axis: dense near it, where lobes are narrow.
fn directions(axis: Vec3) -> Vec<Vec3> {
    let frame = Frame::around(Vector3::from(axis));
    let direction = |i: usize| {
        let (row, column) = (i / COLUMNS, i % COLUMNS);
        let part = row as f32 / (ROWS - 1) as f32;
        let (sin, cos) = (part * part * TAU / 2.0).sin_cos();
        let (s, c) = (column as f32 / (COLUMNS - 1) as f32 * TAU).sin_cos();
        Vec3::from(frame.to_world(vector3(sin * c, sin * s, cos)))
    };
    (0..ROWS * COLUMNS).map(direction).collect()
}

/// Rec. 709.
pub(super) fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Colours as bright as a matte surface may be without drowning its shading.
fn hues(values: &[Vec3]) -> Picture {
    const BRIGHTNESS: f32 = 0.5;
    let hue = |value: &Vec3| *value * (BRIGHTNESS / value.max_element().max(f32::MIN_POSITIVE));
    let plane = |k: usize| values.iter().map(|value| hue(value)[k]).collect();
    let channels = ["R", "G", "B"].into_iter().enumerate();
    Picture {
        width: COLUMNS as u32,
        height: ROWS as u32,
        channels: channels.map(|(k, name)| Channel { name: name.into(), samples: plane(k) }).collect(),
        place: None,
    }
}
