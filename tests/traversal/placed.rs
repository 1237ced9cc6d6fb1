//! Scenes in which groups are placed by instances.

use glam::{DAffine3, DMat3, DVec3};
use packlight::scene::{
    Geometry, GroupIndex, Instance, Material, MaterialIndex, SceneDescription, ShapeGroup,
};

use crate::scenes;

/// Maps that are not harmless: turned, mirrored, sheared, stretched, tiny, huge and far.
fn maps() -> Vec<DAffine3> {
    let scale = |x, y, z| DAffine3::from_scale(DVec3::new(x, y, z));
    let turn = DAffine3::from_rotation_y(0.7) * DAffine3::from_rotation_x(-0.4);
    let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.8, 1.0, 0.1), DVec3::new(-0.3, 0.5, 1.0));
    let at = |x, y, z| DAffine3::from_translation(DVec3::new(x, y, z));
    vec![
        DAffine3::IDENTITY,
        at(1.5, 0.2, -0.3) * turn,
        at(-1.5, 0.0, 0.4) * turn * scale(-1.0, 1.0, 1.0),
        at(0.0, 1.6, 0.0) * DAffine3::from_mat3(shear),
        at(0.1, -1.4, 0.2) * scale(0.3, 1.1, -0.05) * turn,
        at(0.7, 0.8, 0.9) * turn * scale(1e-3, 1e-3, 1e-3),
        at(-0.2, 0.1, 0.3) * scale(1e-3, -2e-3, 0.5) * turn,
        at(40.0, -3.0, 70.0) * turn * scale(25.0, 25.0, 25.0),
        // The second one again: equal hits go to the lower number.
        at(1.5, 0.2, -0.3) * turn,
        // Seen from the side it is a line.
        at(0.3, 0.3, 0.3) * scale(1.0, 1.0, 1e-6),
    ]
}

/// The group that can't be hit.
pub(crate) const DEGENERATE: GroupIndex = GroupIndex(2);

/// Two groups that hold something, one that is empty and one that can't be hit, beside shapes of the scene.
pub(crate) fn everywhere(of: &dyn Fn() -> SceneDescription) -> SceneDescription {
    let group = |shapes| ShapeGroup { name: "group".into(), shapes };
    let mut scene = scenes::quads();
    scene.materials.push(Material::default());
    scene.groups = vec![
        group(of().shapes),
        group(vec![]),
        group(scenes::degenerate().shapes),
        group(scenes::soup(3).shapes),
    ];
    scene.groups[3].shapes[0].material = MaterialIndex(1);
    let places = maps().into_iter().enumerate();
    scene.instances = places
        .flat_map(|(i, to_world)| {
            let other = Instance { group: GroupIndex(1 + i as u32 % 3), to_world };
            [Instance { group: GroupIndex(0), to_world }, other]
        })
        .collect();
    scene
}

/// A soup, disks and cubes in one group; what is round has to be placed to be oval.
pub(crate) fn any_map() -> SceneDescription {
    let mut group = scenes::mixed(60);
    group.shapes.retain(|shape| matches!(shape.geometry, Geometry::Disk | Geometry::Cube));
    group.shapes.extend(scenes::soup(60).shapes);
    group
}

/// The same surfaces, each a shape of the scene.
pub(crate) fn flattened(scene: &SceneDescription) -> SceneDescription {
    let mut flat = SceneDescription { groups: vec![], instances: vec![], ..scene.clone() };
    for instance in &scene.instances {
        for shape in &scene.groups[instance.group.0 as usize].shapes {
            let mut shape = shape.clone();
            shape.to_world = instance.to_world * shape.to_world;
            flat.shapes.push(shape);
        }
    }
    flat
}
