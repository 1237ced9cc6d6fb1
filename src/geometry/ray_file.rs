//! Files of rays: raw little-endian `f32`, eight to a ray, no header.
//!
//! ```text
//! ox oy oz t_near dx dy dz t_far
//! ```
//!
//! The door for rays that others wrote: one that can't be traced is counted and becomes
//! [`Ray32::NEVER`], so that the others keep their places.

use glam::Vec3;

use super::{Ray, RayLanes, Rayx8};
use crate::simd::{LANES, f32x8, transpose, vector3};

/// Bytes of a ray in a file.
pub const RAY_BYTES: usize = 32;

/// A ray as files hold it.
// Aligned to its size: a ray never straddles two cache lines.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Ray32 {
    /// Origin.
    pub org: [f32; 3],
    /// Excluded lower end.
    pub t_near: f32,
    /// Direction; finite, not zero.
    pub dir: [f32; 3],
    /// Included upper end; not −∞.
    pub t_far: f32,
}

impl Ray32 {
    /// A ray that hits nothing: its segment is empty.
    pub const NEVER: Self = Self { org: [0.0; 3], t_near: 0.0, dir: [1.0, 0.0, 0.0], t_far: -1.0 };

    /// A ray from its parts.
    pub fn new(org: Vec3, dir: Vec3, t_near: f32, t_far: f32) -> Self {
        Self { org: org.to_array(), t_near, dir: dir.to_array(), t_far }
    }

    /// Can it be traced? Origin, direction and `t_near` are finite, the direction is not zero, and the
    /// ends are in order, neither of them behind the origin: a tree is searched from there.
    pub fn is_valid(&self) -> bool {
        let finite = |v: [f32; 3]| v.iter().all(|x| x.is_finite());
        finite(self.org)
            && finite(self.dir)
            && self.dir != [0.0; 3]
            && self.t_near.is_finite()
            && self.t_near >= 0.0
            && self.t_near <= self.t_far
    }

    /// The same ray with its reciprocal direction.
    #[inline]
    pub fn ray(&self) -> Ray {
        Ray::new(self.org.into(), self.dir.into(), self.t_near, self.t_far)
    }

    /// The packet of up to eight rays; lanes beyond the last are [`Ray32::NEVER`].
    #[inline(always)]
    pub fn packet(rays: &[Self]) -> Rayx8 {
        // Only the rays go through memory where some are missing: a packet that might would always do so.
        let padded;
        Self::whole_packet(match rays.first_chunk() {
            Some(rays) => rays,
            None => {
                padded = Self::padded(rays);
                &padded
            }
        })
    }

    #[inline(always)]
    fn whole_packet(rays: &[Self; LANES]) -> Rayx8 {
        // One by one: mapped as an array, the rays would be copied first.
        let row = |i: usize| f32x8::new(rays[i].to_array());
        let rows = [row(0), row(1), row(2), row(3), row(4), row(5), row(6), row(7)];
        let [ox, oy, oz, near, dx, dy, dz, far] = transpose(rows);
        RayLanes::new(vector3(ox, oy, oz), vector3(dx, dy, dz), near, far)
    }

    #[cold]
    fn padded(rays: &[Self]) -> [Self; LANES] {
        std::array::from_fn(|i| *rays.get(i).unwrap_or(&Self::NEVER))
    }

    #[inline]
    fn to_array(self) -> [f32; 8] {
        let ([ox, oy, oz], [dx, dy, dz]) = (self.org, self.dir);
        [ox, oy, oz, self.t_near, dx, dy, dz, self.t_far]
    }

    fn from_array([ox, oy, oz, t_near, dx, dy, dz, t_far]: [f32; 8]) -> Self {
        Self { org: [ox, oy, oz], t_near, dir: [dx, dy, dz], t_far }
    }
}

/// The rays of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RayFile {
    /// In the order of the file.
    pub rays: Vec<Ray32>,
    /// How many could not be traced and are [`Ray32::NEVER`].
    pub invalid: u64,
}

/// Why the bytes of a file are not rays.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{bytes} bytes are not a whole number of rays, which have {RAY_BYTES} each")]
pub struct RayFileError {
    /// Length of the file.
    pub bytes: usize,
}

impl RayFile {
    /// Rays from the bytes of a file.
    ///
    /// # Errors
    /// [`RayFileError`] if a ray is cut off.
    pub fn decode(bytes: &[u8]) -> Result<Self, RayFileError> {
        let (chunks, rest) = bytes.as_chunks::<RAY_BYTES>();
        if !rest.is_empty() {
            return Err(RayFileError { bytes: bytes.len() });
        }
        let mut file = Self { rays: Vec::with_capacity(chunks.len()), invalid: 0 };
        for chunk in chunks {
            let (words, _) = chunk.as_chunks::<4>();
            let ray = Ray32::from_array(std::array::from_fn(|i| f32::from_le_bytes(words[i])));
            let valid = ray.is_valid();
            file.invalid += u64::from(!valid);
            file.rays.push(if valid { ray } else { Ray32::NEVER });
        }
        Ok(file)
    }
}

/// The bytes of a file with these rays.
pub fn encode(rays: &[Ray32]) -> Vec<u8> {
    rays.iter().flat_map(|ray| ray.to_array()).flat_map(f32::to_le_bytes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::Real;

    fn ray() -> Ray32 {
        Ray32::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.0, -0.0, -2.0), 0.5, f32::INFINITY)
    }

    #[test]
    fn bytes_are_in_the_documented_order() {
        let bytes = encode(&[ray()]);
        let words: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|w| f32::from_le_bytes(*w)).collect();
        assert_eq!(words, [1.0, 2.0, 3.0, 0.5, 0.0, 0.0, -2.0, f32::INFINITY]);
        assert_eq!(RayFile::decode(&bytes).unwrap(), RayFile { rays: vec![ray()], invalid: 0 });
        assert_eq!(RayFile::decode(&bytes[1..]), Err(RayFileError { bytes: 31 }));
        assert_eq!(RayFile::decode(&[]).unwrap().rays, []);
    }

    #[test]
    fn rays_that_cannot_be_traced_keep_their_places() {
        let nan = f32::NAN;
        let bad = [
            Ray32 { org: [nan, 0.0, 0.0], ..ray() },
            Ray32 { org: [0.0, f32::INFINITY, 0.0], ..ray() },
            Ray32 { dir: [0.0, -0.0, 0.0], ..ray() },
            Ray32 { dir: [0.0, nan, 1.0], ..ray() },
            Ray32 { t_near: nan, ..ray() },
            Ray32 { t_near: f32::NEG_INFINITY, t_far: f32::NEG_INFINITY, ..ray() },
            Ray32 { t_far: nan, ..ray() },
            Ray32 { t_near: 2.0, t_far: 1.0, ..ray() },
            Ray32 { t_near: -0.1, t_far: 0.0, ..ray() },
            Ray32 { t_near: -f32::MIN_POSITIVE, ..ray() },
        ];
        let mut rays = bad.to_vec();
        rays.insert(3, ray());
        let file = RayFile::decode(&encode(&rays)).unwrap();
        assert_eq!(file.invalid, bad.len() as u64);
        for (i, read) in file.rays.iter().enumerate() {
            assert_eq!(*read, if i == 3 { ray() } else { Ray32::NEVER }, "{i}");
        }
    }

    #[test]
    fn lanes_are_the_rays() {
        let packet = Ray32::packet(&[ray(), ray(), ray()]);
        for lane in 0..LANES {
            let (lane, whole) = (packet.lane(lane), if lane < 3 { ray() } else { Ray32::NEVER }.ray());
            assert_eq!((lane.org, lane.dir, lane.rdir), (whole.org, whole.dir, whole.rdir));
            assert_eq!((lane.t_near, lane.t_far), (whole.t_near, whole.t_far));
        }
        assert_eq!(packet.t_far.lane(7), -1.0);
    }
}
