//! Reflection models, as a file names them.

use super::{Rgb, Texture};

/// A reflection model and its parameters. Reflectances are in [0, 1].
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// Lambert: f = ρ/π on the side of the normal, black from behind.
    Diffuse {
        /// ρ.
        reflectance: Texture,
    },
    /// Ideal mirror with the exact Fresnel reflectance of a conductor, on the side of the normal.
    Conductor {
        /// Real part of the index of refraction, per channel, relative to vacuum.
        eta: Rgb,
        /// Imaginary part (absorption), per channel.
        k: Rgb,
        /// Factor on the reflected light; 1 for physical surfaces.
        specular_reflectance: Texture,
    },
    /// Ideal glass: the side that the normal points to is the exterior.
    Dielectric {
        /// Index of refraction inside.
        int_ior: f32,
        /// Index of refraction outside.
        ext_ior: f32,
        /// Factor on reflected light; 1 for physical surfaces.
        specular_reflectance: Texture,
        /// Factor on refracted light; 1 for physical surfaces.
        specular_transmittance: Texture,
    },
    /// Energy-normalised modified Phong: ρ_d/π + ρ_s (n+2)/2π cosⁿα, on the side of the normal.
    Phong {
        /// ρ_d.
        diffuse_reflectance: Texture,
        /// ρ_s; ρ_d + ρ_s ≤ 1 conserves energy.
        specular_reflectance: Texture,
        /// n.
        exponent: f32,
    },
    /// An opaque material that is shaded on both sides, as if the side seen were the front.
    TwoSided {
        /// The side of the normal; never itself `TwoSided` or `Dielectric`.
        front: Box<Material>,
        /// The other side; `None` is the same as the front.
        back: Option<Box<Material>>,
    },
}

impl Default for Material {
    fn default() -> Self {
        Self::Diffuse { reflectance: Texture::Constant(Rgb::splat(0.5)) }
    }
}
