//! Three-vectors of lanes.

use std::ops::{Add, Mul, Neg, Sub};

use glam::Vec3;

use super::{Real, f32x8, f32x16};

/// Three [`Real`]s: a point, a direction, a normal or a linear sRGB colour.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vector3<R> {
    /// First component.
    pub x: R,
    /// Second component.
    pub y: R,
    /// Third component.
    pub z: R,
}

/// Eight vectors.
pub type Vec3x8 = Vector3<f32x8>;

/// Sixteen vectors.
pub type Vec3x16 = Vector3<f32x16>;

/// `Vector3 { x, y, z }`.
#[inline]
pub const fn vector3<R>(x: R, y: R, z: R) -> Vector3<R> {
    Vector3 { x, y, z }
}

impl<R: Real> Vector3<R> {
    /// The same vector in every lane.
    #[inline]
    pub fn splat(v: Vec3) -> Self {
        vector3(R::splat(v.x), R::splat(v.y), R::splat(v.z))
    }

    /// Lane `i` is `f(i)`.
    #[inline]
    pub fn from_fn(mut f: impl FnMut(usize) -> Vec3) -> Self {
        let mut lanes = [Vec3::ZERO; 16];
        for (i, lane) in lanes[..R::LANES].iter_mut().enumerate() {
            *lane = f(i);
        }
        vector3(R::from_fn(|i| lanes[i].x), R::from_fn(|i| lanes[i].y), R::from_fn(|i| lanes[i].z))
    }

    /// The vector of a lane.
    #[inline]
    pub fn lane(self, i: usize) -> Vec3 {
        Vec3::new(self.x.lane(i), self.y.lane(i), self.z.lane(i))
    }

    /// Zero in every lane.
    #[inline]
    pub fn zero() -> Self {
        Self::splat(Vec3::ZERO)
    }

    /// x·x' + y·y' + z·z', added from left to right.
    #[inline]
    pub fn dot(self, rhs: Self) -> R {
        self.x * rhs.x + self.y * rhs.y + self.z * rhs.z
    }

    /// Right-handed; exactly antisymmetric.
    #[inline]
    pub fn cross(self, rhs: Self) -> Self {
        vector3(
            self.y * rhs.z - self.z * rhs.y,
            self.z * rhs.x - self.x * rhs.z,
            self.x * rhs.y - self.y * rhs.x,
        )
    }

    /// Each component times a number.
    #[inline]
    pub fn scale(self, factor: R) -> Self {
        vector3(self.x * factor, self.y * factor, self.z * factor)
    }

    /// √(v·v).
    #[inline]
    pub fn length(self) -> R {
        self.dot(self).sqrt()
    }

    /// v / |v|; not finite for a zero vector.
    #[inline]
    pub fn normalize(self) -> Self {
        self.scale(R::one() / self.length())
    }

    /// v / |v|, or `fallback` where that is not finite and non-zero.
    #[inline]
    pub fn normalize_or(self, fallback: Self) -> Self {
        let squared = self.dot(self);
        let usable = squared.gt(R::zero()) & squared.lt(R::splat(f32::INFINITY));
        Self::select(usable, self.scale(R::one() / squared.sqrt()), fallback)
    }

    /// `if mask { a } else { b }`, lane by lane.
    #[inline]
    pub fn select(mask: R::Mask, a: Self, b: Self) -> Self {
        vector3(R::select(mask, a.x, b.x), R::select(mask, a.y, b.y), R::select(mask, a.z, b.z))
    }

    /// v if the mask says so, else 0.
    #[inline]
    pub fn only(self, mask: R::Mask) -> Self {
        Self::select(mask, self, Self::zero())
    }

    /// Component by component, to vectors of other lanes too.
    #[inline]
    pub fn map<S>(self, mut f: impl FnMut(R) -> S) -> Vector3<S> {
        vector3(f(self.x), f(self.y), f(self.z))
    }

    /// Component by component, [`Real::min`].
    #[inline]
    pub fn min(self, rhs: Self) -> Self {
        vector3(self.x.min(rhs.x), self.y.min(rhs.y), self.z.min(rhs.z))
    }

    /// Component by component, [`Real::max`].
    #[inline]
    pub fn max(self, rhs: Self) -> Self {
        vector3(self.x.max(rhs.x), self.y.max(rhs.y), self.z.max(rhs.z))
    }

    /// Component by component, |x|.
    #[inline]
    pub fn abs(self) -> Self {
        self.map(R::abs)
    }

    /// x + y + z.
    #[inline]
    pub fn element_sum(self) -> R {
        self.x + self.y + self.z
    }

    /// The greatest component.
    #[inline]
    pub fn max_element(self) -> R {
        self.x.max(self.y).max(self.z)
    }
}

impl From<Vec3> for Vector3<f32> {
    #[inline]
    fn from(v: Vec3) -> Self {
        vector3(v.x, v.y, v.z)
    }
}

impl From<Vector3<f32>> for Vec3 {
    #[inline]
    fn from(v: Vector3<f32>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

macro_rules! component_by_component {
    ($($trait:ident $verb:ident $op:tt),*) => {$(
        impl<R: Real> $trait for Vector3<R> {
            type Output = Self;
            #[inline]
            fn $verb(self, rhs: Self) -> Self {
                vector3(self.x $op rhs.x, self.y $op rhs.y, self.z $op rhs.z)
            }
        }
    )*};
}
component_by_component!(Add add +, Sub sub -, Mul mul *);

impl<R: Real> Neg for Vector3<R> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.map(|x| -x)
    }
}
