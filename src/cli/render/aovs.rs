//! `--aov`: layers beside the picture.

use clap::ValueEnum;

use crate::scene::{Aov, AovChannel};

/// A layer as it is typed; its channels begin with the same word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(super) enum Layer {
    /// Share of light that the surface reflects: albedo.R, .G, .B
    Albedo,
    /// Shading normal in world space: normal.X, .Y, .Z
    Normal,
    /// Distance along the ray, 0 where nothing is: depth.Z
    Depth,
    /// World space: position.X, .Y, .Z
    Position,
    /// Texture coordinates: uv.U, .V
    Uv,
    /// Normal of the surface itself: geo_normal.X, .Y, .Z
    GeoNormal,
    /// Number of the material from 1: material_id.I
    MaterialId,
    /// Number of the primitive from 1: primitive_id.I
    PrimitiveId,
    /// Nodes of the tree that the camera ray meets: nodes.N
    Nodes,
    /// Primitives that the camera ray is tested against: primitives.N
    Primitives,
}

impl Layer {
    /// The layer by its name.
    pub(super) fn channel(self) -> AovChannel {
        let kind = match self {
            Self::Albedo => Aov::DirectionalAlbedo,
            Self::Normal => Aov::ShNormal,
            Self::Depth => Aov::Depth,
            Self::Position => Aov::Position,
            Self::Uv => Aov::Uv,
            Self::GeoNormal => Aov::GeoNormal,
            Self::MaterialId => Aov::MaterialId,
            Self::PrimitiveId => Aov::PrimitiveId,
            Self::Nodes => Aov::Nodes,
            Self::Primitives => Aov::Primitives,
        };
        let name = self.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default();
        AovChannel { name, kind }
    }
}
