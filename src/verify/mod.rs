//! Does this scene get the answers it should? What the tests ask of scenes made for them, asked of any.
//!
//! [`ways`]: every way through the tree, and testing every primitive, against single rays. [`cracks`]: rays
//! at edges and vertices that are shared. [`departures`]: rays that leave a triangle and must not meet it
//! again. [`against`]: somebody else's hits ([`embree`]). What is wrong is handed out as an [`Exhibit`], as
//! small as it shows.

pub mod against;
pub mod aim;
pub mod cracks;
pub mod departures;
pub mod embree;
mod reduce;
pub mod ways;

use glam::{DAffine3, Vec3};

use crate::compile::{Scene, compile};
use crate::geometry::Ray32;
use crate::render::{Query, ray_classes};
use crate::scene::{Geometry, Material, MaterialIndex, Mesh, SceneDescription, Shape};

/// Neighbours that are judged together by the tree.
const RUN: usize = 64;
/// Kinds of rays that [`aim::rays_at`] makes of one count.
const KINDS: usize = 21;

/// What a wrong answer needs to be seen again.
#[derive(Clone, Debug, PartialEq)]
pub struct Exhibit {
    /// In a sentence.
    pub what: String,
    /// Enough of them, in world space; empty if it takes the whole scene.
    pub triangles: Vec<[Vec3; 3]>,
    /// In their order.
    pub rays: Vec<Ray32>,
    /// What every one of these rays should find; `None` if the ways should agree.
    pub expected: Option<Expected>,
}

/// What rays should find.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expected {
    /// Something.
    Hit,
    /// Nothing.
    Miss,
}

/// Rays of one kind, named.
#[derive(Clone, Debug)]
pub struct Class {
    /// What for.
    pub name: &'static str,
    /// What a renderer asks of them.
    pub query: Query,
    /// Whole runs, if there were enough.
    pub rays: Vec<Ray32>,
}

/// The scene's own rays, at most about `most` a class, and as many adversarial ones.
pub fn classes(scene: &Scene, most: usize) -> Vec<Class> {
    let own = ray_classes(scene).into_iter();
    let mut classes: Vec<Class> = own
        .map(|class| Class { name: class.name, query: class.query, rays: spread(&class.rays, most) })
        .collect();
    let mut random = aim::Random::new(1);
    let aimed = aim::rays_at(&aim::targets(scene), (most / KINDS).max(1), &mut random);
    let rays = aimed.iter().map(|ray| Ray32::new(ray.org, ray.dir, ray.t_near, ray.t_far));
    classes.push(Class { name: "adversarial", query: Query::Closest, rays: rays.collect() });
    classes
}

/// Runs of neighbours, evenly spread.
fn spread(rays: &[Ray32], most: usize) -> Vec<Ray32> {
    let (runs, wanted) = (rays.len().div_ceil(RUN), most.div_ceil(RUN).max(1));
    if runs <= wanted {
        return rays.to_vec();
    }
    let run = |i: usize| rays.chunks(RUN).nth(i * runs / wanted).unwrap_or_default();
    (0..wanted).flat_map(|i| run(i).iter().copied()).collect()
}

/// A scene of nothing but triangles, each by itself; `None` if they reach too far.
pub fn scene_of(triangles: &[[Vec3; 3]]) -> Option<Scene> {
    let mesh = Mesh {
        positions: triangles.iter().flatten().copied().collect(),
        triangles: (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        ..Mesh::default()
    };
    let shape = Shape {
        name: String::new(),
        geometry: Geometry::Mesh { mesh: mesh.into(), face_normals: true },
        to_world: DAffine3::IDENTITY,
        flip_normals: false,
        material: MaterialIndex(0),
        radiance: None,
    };
    let materials = vec![Material::default()];
    compile(&SceneDescription { shapes: vec![shape], materials, ..Default::default() }).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_the_rays_is_whole_runs_from_all_over() {
        let rays: Vec<Ray32> = (0..1000).map(|i| Ray32 { t_far: i as f32, ..Ray32::NEVER }).collect();
        assert_eq!(spread(&rays, 1000), rays);
        let some = spread(&rays, 256);
        assert_eq!(some.len(), 256);
        assert_eq!(some[..RUN], rays[..RUN]);
        assert_eq!(some[3 * RUN..], rays[12 * RUN..13 * RUN]);
    }
}
