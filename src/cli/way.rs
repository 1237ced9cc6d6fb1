//! `--way`: how rays go through the tree.

use clap::ValueEnum;

use crate::{bvh::Way, render::Route};

/// A [`Way`] as it is typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum WayName {
    /// Whatever suits each 64 rays
    Chosen,
    /// Tiles of 64 rays from one point into one octant; others as packets
    Tile,
    /// Packets of 8
    Packet,
    /// 16 single rays in turn
    Wave,
}

impl From<WayName> for Way {
    fn from(name: WayName) -> Self {
        match name {
            WayName::Chosen => Self::Chosen,
            WayName::Tile => Self::Tile,
            WayName::Packet => Self::Packet,
            WayName::Wave => Self::Wave,
        }
    }
}

/// A [`Route`] as it is typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum RouteName {
    /// Whatever suits each 64 rays
    Chosen,
    /// Tiles of 64 rays from one point into one octant; others as packets
    Tile,
    /// Packets of 8
    Packet,
    /// 16 single rays in turn
    Wave,
    /// One ray after the other
    Single,
}

impl From<RouteName> for Route {
    fn from(name: RouteName) -> Self {
        Self::Stream(match name {
            RouteName::Chosen => Way::Chosen,
            RouteName::Tile => Way::Tile,
            RouteName::Packet => Way::Packet,
            RouteName::Wave => Way::Wave,
            RouteName::Single => return Self::Single,
        })
    }
}
