//! A description to columns in leaf order, ids and a tree.

use std::time::Duration;

use crate::scene::SceneDescription;

/// A scene ready to be traced.
#[derive(Debug, Default)]
pub struct Scene {
    summary: Summary,
    /// (skeleton)
    pub film: crate::scene::Film,
}

/// What was compiled, for people.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Triangles that can be hit.
    pub triangles: u64,
    /// Spheres, disks and cylinders.
    pub quadrics: u64,
    /// Triangles left out because they have no area.
    pub degenerate: u64,
    /// Materials after compilation.
    pub materials: u32,
    /// Lights, area lights included.
    pub lights: u32,
    /// Nodes of the tree.
    pub bvh_nodes: u64,
    /// Bytes that tracing reads: nodes and primitive blocks.
    pub bvh_bytes: u64,
    /// Time to build the tree.
    pub bvh_time: Duration,
}

impl Scene {
    /// What was compiled.
    pub fn summary(&self) -> Summary {
        self.summary
    }
}

/// Why a description can't be compiled.
#[derive(Debug, Clone, thiserror::Error)]
pub enum CompileError {
    /// More primitives than a tree can name.
    #[error("the scene has {0} primitives, more than the {max} that a tree can hold; split it", max = 1u64 << 28)]
    TooManyPrimitives(u64),
}

/// Builds columns, lights, materials and the tree.
///
/// # Errors
/// [`CompileError`].
pub fn compile(description: &SceneDescription) -> Result<Scene, CompileError> {
    let _ = description;
    Ok(Scene::default())
}
