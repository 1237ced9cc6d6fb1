//! What ways through the tree cost, so that they can be compared by what they do.

use std::ops::{Add, AddAssign, Mul};

/// Processor cycles, as the parts of each way took them on one machine (Zen 4). Only their ratios count,
/// and a ray's way never shows in its answer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Cost(pub(super) f32);

impl Cost {
    /// A tile set up.
    pub(super) const TILE: Self = Self(1200.0);
    /// A node of a tile, and each child that the tile may enter.
    pub(super) const TILE_NODE: Self = Self(40.0);
    pub(super) const TILE_CHILD: Self = Self(25.0);
    /// A leaf of a tile, and the planes of each primitive.
    pub(super) const TILE_LEAF: Self = Self(80.0);
    pub(super) const TILE_PLANES: Self = Self(25.0);
    /// Sixteen rays against a primitive.
    pub(super) const PACKET_TEST: Self = Self(80.0);
    /// A packet of sixteen, its nodes, and the children that it enters.
    pub(super) const PACKET: Self = Self(150.0);
    pub(super) const PACKET_NODE: Self = Self(45.0);
    /// A node of a packet that points into several octants: eight tests of a box.
    pub(super) const PACKET_NODE_APART: Self = Self(340.0);
    pub(super) const PACKET_CHILD: Self = Self(30.0);
    /// How much more packets cost whose nodes are far away in memory, or whose rays are scattered and don't end at
    /// the first hit: they wait for one node after the other.
    pub(super) const FAR: f32 = 2.0;
    /// How much more runs of occlusion rays cost together: rays end one by one, and those that are left go on in
    /// lanes of their own.
    pub(super) const OCCLUSION: f32 = 1.8;
    /// A ray on its own, its nodes, and its blocks.
    pub(super) const RAY: Self = Self(50.0);
    pub(super) const RAY_NODE: Self = Self(28.0);
    pub(super) const RAY_BLOCK: Self = Self(55.0);
}

impl Mul<u32> for Cost {
    type Output = Self;
    fn mul(self, times: u32) -> Self {
        Self(self.0 * times as f32)
    }
}

impl Mul<f32> for Cost {
    type Output = Self;
    fn mul(self, factor: f32) -> Self {
        Self(self.0 * factor)
    }
}

impl Add for Cost {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl AddAssign for Cost {
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}
