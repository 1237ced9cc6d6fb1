//! Values that vary over a surface, fetched for many lanes at once.

mod attribute;
mod bitmap;

pub use attribute::{Column, MeshAttribute};
pub use bitmap::{Bitmap, Filter, Wrap};

use glam::{DAffine2, Vec3};

use crate::simd::{Bits, Real, Vector3};

/// Which texture of a [`TextureTable`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TextureId(pub u32);

/// Where textures are looked up.
#[derive(Clone, Copy, Debug)]
pub struct Coordinates<R: Real> {
    /// Grows along ∂p/∂u.
    pub u: R,
    /// Grows along ∂p/∂v.
    pub v: R,
    /// Which mesh it is, among those with attributes; no other surface has a number that one of them has.
    pub mesh: R::Bits,
    /// Which triangle of it.
    pub face: R::Bits,
    /// Barycentric, of the triangle's second and third corner.
    pub weights: (R, R),
}

impl<R: Real> From<(R, R)> for Coordinates<R> {
    /// Of a surface without attributes.
    #[inline]
    fn from((u, v): (R, R)) -> Self {
        let none = R::Bits::splat(u32::MAX);
        Self { u, v, mesh: none, face: none, weights: (R::zero(), R::zero()) }
    }
}

impl<R: Real> Coordinates<R> {
    /// `if mask { a } else { b }`, lane by lane.
    #[inline]
    pub fn select(mask: R::Mask, a: Self, b: Self) -> Self {
        let select = |a, b| R::select(mask, a, b);
        Self {
            u: select(a.u, b.u),
            v: select(a.v, b.v),
            mesh: R::Bits::select(mask, a.mesh, b.mesh),
            face: R::Bits::select(mask, a.face, b.face),
            weights: (select(a.weights.0, b.weights.0), select(a.weights.1, b.weights.1)),
        }
    }
}

/// An affine map of texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvMap {
    rows: [[f32; 3]; 2],
}

impl UvMap {
    /// From the map in double precision.
    pub fn new(map: DAffine2) -> Self {
        let (m, t) = (map.matrix2, map.translation);
        let row = |x: f64, y: f64, t: f64| [x as f32, y as f32, t as f32];
        Self { rows: [row(m.x_axis.x, m.y_axis.x, t.x), row(m.x_axis.y, m.y_axis.y, t.y)] }
    }

    /// The image of (u, v).
    #[inline]
    pub fn apply<R: Real>(&self, (u, v): (R, R)) -> (R, R) {
        let row = |[a, b, c]: [f32; 3]| R::splat(a) * u + R::splat(b) * v + R::splat(c);
        (row(self.rows[0]), row(self.rows[1]))
    }

    /// The gradient in (u, v) of a function whose gradient at the image is (x, y).
    #[inline]
    fn pull_back<R: Real>(&self, (x, y): (R, R)) -> (R, R) {
        let [[a, b, _], [c, d, _]] = self.rows.map(|row| row.map(R::splat));
        (a * x + c * y, b * x + d * y)
    }
}

/// A texture ready to be evaluated; the meaning is that of the scene's description.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// The same everywhere, linear sRGB.
    Constant(Vec3),
    /// `colors[0]` where (frac u > ½) == (frac v > ½).
    Checkerboard {
        /// Linear sRGB.
        colors: [Vec3; 2],
        /// Applied first.
        map: UvMap,
    },
    /// A picture.
    Bitmap {
        /// The texels.
        bitmap: Bitmap,
        /// Applied first.
        map: UvMap,
    },
    /// Values on meshes.
    MeshAttribute(MeshAttribute),
}

/// All textures of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TextureTable {
    textures: Vec<Texture>,
}

impl TextureTable {
    /// Adds a texture; equal constants share a place.
    pub fn add(&mut self, texture: Texture) -> TextureId {
        let shared = match texture {
            Texture::Constant(_) => self.textures.iter().position(|t| *t == texture),
            _ => None,
        };
        let place = shared.unwrap_or_else(|| {
            self.textures.push(texture);
            self.textures.len() - 1
        });
        TextureId(place as u32)
    }

    /// The colour of one texture where each lane looks it up.
    #[inline]
    pub fn fetch<R: Real>(&self, id: TextureId, at: Coordinates<R>) -> Vector3<R> {
        match &self.textures[id.0 as usize] {
            Texture::Constant(color) => Vector3::splat(*color),
            Texture::Checkerboard { colors, map } => {
                let (u, v) = map.apply((at.u, at.v));
                let high = |x: R| (x - x.floor()).gt(R::splat(0.5));
                let (u, v) = (high(u), high(v));
                let same = (u & v) | (!u & !v);
                Vector3::select(same, Vector3::splat(colors[0]), Vector3::splat(colors[1]))
            }
            Texture::Bitmap { bitmap, map } => bitmap.fetch(map.apply((at.u, at.v))),
            Texture::MeshAttribute(attribute) => attribute.fetch(at),
        }
    }

    /// A texture as a number: its luminance. Constants are grey, and taken as they are.
    #[inline]
    pub fn fetch_number<R: Real>(&self, id: TextureId, at: Coordinates<R>) -> R {
        match &self.textures[id.0 as usize] {
            Texture::Constant(color) => R::splat(color.x),
            _ => luminance(self.fetch(id, at)),
        }
    }

    /// How fast the number changes with u and with v: 0 but for a bilinear bitmap.
    #[inline]
    pub fn gradient<R: Real>(&self, id: TextureId, at: Coordinates<R>) -> (R, R) {
        match &self.textures[id.0 as usize] {
            Texture::Bitmap { bitmap, map } if bitmap.filter == Filter::Bilinear => {
                let [along_u, along_v] = bitmap.gradient(map.apply((at.u, at.v)));
                map.pull_back((luminance(along_u), luminance(along_v)))
            }
            _ => (R::zero(), R::zero()),
        }
    }
}

/// Y of a linear sRGB colour.
#[inline]
fn luminance<R: Real>(c: Vector3<R>) -> R {
    R::splat(0.212_671) * c.x + R::splat(0.715_16) * c.y + R::splat(0.072_169) * c.z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::f32x8;

    fn ramp() -> (TextureTable, TextureId) {
        let mut table = TextureTable::default();
        let texels = (0..16).map(|i| [(i % 4) as f32 * 0.25 + (i / 4) as f32 * 0.0625; 3]).collect();
        let bitmap = Bitmap { texels, width: 4, height: 4, filter: Filter::Bilinear, wrap: Wrap::Clamp };
        let map = UvMap::new(DAffine2::from_scale(glam::dvec2(2.0, 1.0)));
        let id = table.add(Texture::Bitmap { bitmap, map });
        (table, id)
    }

    #[test]
    fn gradients_are_differences() {
        let (table, id) = ramp();
        let (u, v) = (0.21, 0.43);
        let (along_u, along_v) = table.gradient::<f32>(id, (u, v).into());
        // 0.25 a texel, four texels a unit, twice as fast by the map.
        assert!((along_u - 2.0).abs() < 1e-5 && (along_v - 0.25).abs() < 1e-5, "{along_u} {along_v}");
        let step = 0.01;
        let at = |u, v| table.fetch_number::<f32>(id, (u, v).into());
        assert!(((at(u + step, v) - at(u, v)) / step - along_u).abs() < 1e-3);
        assert!(((at(u, v + step) - at(u, v)) / step - along_v).abs() < 1e-3);
        let lanes = table.gradient(id, (f32x8::splat(u), f32x8::splat(v)).into());
        assert_eq!((lanes.0.lane(3), lanes.1.lane(7)), (along_u, along_v));
        let flat = TextureTable { textures: vec![Texture::Constant(Vec3::ONE)] };
        assert_eq!(flat.gradient::<f32>(TextureId(0), (u, v).into()), (0.0, 0.0));
    }

    #[test]
    fn numbers_are_luminances() {
        let (table, id) = ramp();
        let grey = table.fetch::<f32>(id, (0.2, 0.6).into()).x;
        assert!((table.fetch_number::<f32>(id, (0.2, 0.6).into()) - grey).abs() < 1e-6);
        let mut table = TextureTable::default();
        let id = table.add(Texture::Constant(Vec3::splat(0.1)));
        assert_eq!(table.fetch_number::<f32>(id, (0.0, 0.0).into()), 0.1);
    }

    #[test]
    fn checkerboard_has_two_fields_a_unit_and_color0_at_the_origin() {
        let mut table = TextureTable::default();
        let map = UvMap::new(DAffine2::from_scale(glam::dvec2(8.0, 4.0)));
        let id = table.add(Texture::Checkerboard { colors: [Vec3::ONE, Vec3::ZERO], map });
        for (u, v, want) in
            [(0.01, 0.01, 1.0), (0.1, 0.01, 0.0), (0.1, 0.2, 1.0), (-0.01, 0.01, 0.0), (1.01, 0.01, 1.0)]
        {
            assert_eq!(table.fetch::<f32>(id, (u, v).into()).x, want, "{u} {v}");
            assert_eq!(table.fetch(id, (f32x8::splat(u), f32x8::splat(v)).into()).x.lane(5), want);
        }
    }

    #[test]
    fn equal_constants_share_a_place() {
        let mut table = TextureTable::default();
        let [a, b, c] = [0.5, 0.25, 0.5].map(|x| table.add(Texture::Constant(Vec3::splat(x))));
        assert_eq!((a, a != b), (c, true));
    }
}
