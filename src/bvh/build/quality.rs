//! How much work goes into a tree.

use super::{
    Reference,
    binary::Binary,
    binned,
    collapse::{Weighed, collapse},
    morton,
    reference::Names,
    reinsert,
    weigh::Choices,
};
use crate::bvh::Bvh;
use crate::geometry::Aabb;

/// How much work goes into a tree. Hits are the same to the bit; what differs is the time to build the
/// tree and the time to trace rays through it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Sorted along the Morton curve \[LGS09\]: for a first look, or a scene that changes with every frame.
    /// Built in 0.5 to 0.65 of medium's time; the SAH cost is 1.03 (soup) to 1.25 (terrain) of medium's.
    Fast,
    /// Binned SAH \[Wal07\], exact for the last sixteen primitives: for most pictures.
    #[default]
    Medium,
    /// Medium, then optimised by reinsertion \[MB18\]: for rays by the hundred million. Built in 4 to 8 times
    /// medium's time; the SAH cost is 0.83 (kitchen), 0.86 (Sponza) to 0.998 (terrain) of medium's.
    High,
}

impl Bvh {
    /// Builds a tree over the references, on the current rayon pool. The same references and quality
    /// give the same tree for any number of threads.
    pub fn build_with(mut references: Vec<Reference>, quality: Quality) -> Self {
        if references.is_empty() {
            return Self::default();
        }
        let binary = match quality {
            Quality::Fast => morton::build(&mut references),
            Quality::Medium => binned::build(&mut references),
            Quality::High => {
                let binary = binned::build(&mut references);
                reinsert::reinsert(binary, &mut references)
            }
        };
        // From here on only leaves name primitives.
        let names = Names::new(references);
        let choices = Choices::new(&binary, &names);
        let Aabb { min, max } = Binary::unpack(&binary[0]).bounds.aabb();
        let (nodes, slots) = collapse(Weighed { nodes: &binary, choices: &choices, names: &names });
        Self { nodes, slots, reach: min.abs().max(max.abs()) }
    }

    /// [`Bvh::build_with`] the default quality.
    pub fn build(references: Vec<Reference>) -> Self {
        Self::build_with(references, Quality::default())
    }
}
