//! `--way`: how rays go through the tree.

use clap::{ValueEnum, builder::PossibleValue};

use crate::{bvh::Way, render::Route};

/// A [`Way`] as it is typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum WayName {
    /// Whatever suits each 64 rays
    Chosen,
    /// Tiles of up to 256 rays from one point into one octant; others as packets
    Tile,
    /// Packets of 16
    Packet,
    /// 32 single rays in turn
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

/// A [`Route`] as it is typed: a way, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RouteName {
    Stream(WayName),
    Single,
}

impl ValueEnum for RouteName {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: [RouteName; 5] = [
            RouteName::Stream(WayName::Chosen),
            RouteName::Stream(WayName::Tile),
            RouteName::Stream(WayName::Packet),
            RouteName::Stream(WayName::Wave),
            RouteName::Single,
        ];
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            Self::Stream(way) => way.to_possible_value(),
            Self::Single => Some(PossibleValue::new("single").help("One ray after the other")),
        }
    }
}

impl From<RouteName> for Route {
    fn from(name: RouteName) -> Self {
        match name {
            RouteName::Stream(way) => Self::Stream(way.into()),
            RouteName::Single => Self::Single,
        }
    }
}
