//! Which integral is estimated for each pixel.

/// The integrator and its parameters, with Mitsuba's meaning where Mitsuba has the name.
#[derive(Clone, Debug, PartialEq)]
pub enum Integrator {
    /// The rendering equation: next-event estimation and BSDF sampling, combined by MIS.
    Path {
        /// Vertices of light transport counted from the eye: 1 shows emitters, 2 is direct light.
        /// `None` is no limit.
        max_depth: Option<u32>,
        /// Russian roulette begins after this many vertices.
        rr_depth: u32,
        /// Emitters seen directly are left out of the picture.
        hide_emitters: bool,
    },
    /// The reflection equation: direct light only, mirrors and glass are not followed.
    Direct {
        /// Emitters seen directly are left out of the picture.
        hide_emitters: bool,
    },
    /// Whitted's recursion: direct light at smooth surfaces, both branches at mirrors and glass.
    Whitted {
        /// Vertices counted from the eye, as for [`Integrator::Path`].
        max_depth: u32,
    },
    /// The share of the hemisphere, weighted by the cosine, in which nothing is near.
    AmbientOcclusion {
        /// What is farther, in units of the world, does not count; +∞ is no limit.
        distance: f32,
    },
    /// Irradiance of what the camera sees, on the side that it sees, W/m².
    Irradiance {
        /// As for [`Integrator::Path`]; the surface that is measured counts as a vertex.
        max_depth: Option<u32>,
        /// As for [`Integrator::Path`].
        rr_depth: u32,
    },
    /// What the camera sees, in place of light.
    Aov {
        /// In the order of the file; each becomes channels `name.SUFFIX`.
        channels: Vec<AovChannel>,
    },
}

impl Default for Integrator {
    fn default() -> Self {
        Self::Path { max_depth: None, rr_depth: 5, hide_emitters: false }
    }
}

/// A named output of [`Integrator::Aov`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AovChannel {
    /// Prefix of the channels' names.
    pub name: String,
    /// What is written.
    pub kind: Aov,
}

/// An arbitrary output variable. A ray that hits nothing writes 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// Distance along the ray from the near plane, in units of the world, `.T`.
    Depth,
    /// Hit point in world space, `.X .Y .Z`.
    Position,
    /// Texture coordinates, `.U .V`.
    Uv,
    /// Geometric normal in world space as the surface stores it, `.X .Y .Z`.
    GeoNormal,
    /// Shading normal in world space as the surface stores it, `.X .Y .Z`.
    ShNormal,
    /// ∫ f |cos θ| dω for the direction of view, `.R .G .B`.
    DirectionalAlbedo,
    /// The material's number from 1 up, `.I`; numbers go by kind.
    MaterialId,
    /// The primitive's number from 1 up, in the order of the file, `.I`.
    PrimitiveId,
    /// Nodes of the tree that the camera ray is tested against by itself, `.N`, whether it hits or not.
    Nodes,
    /// Primitives likewise, `.N`.
    Primitives,
}
