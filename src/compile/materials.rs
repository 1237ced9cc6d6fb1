//! Described materials to rows of the table.

use std::sync::Arc;

use crate::material::{MaterialId, MaterialRow, MaterialTable, Model};
use crate::picture::Picture;
use crate::scene;
use crate::texture::{Bitmap, Filter, Texture, TextureId, TextureTable, UvMap, Wrap};

/// The table, its textures, and the id of each described material.
pub(super) fn compile(materials: &[scene::Material]) -> (MaterialTable, TextureTable, Vec<MaterialId>) {
    let mut textures = Textures { table: TextureTable::default(), seen: vec![] };
    let rows: Vec<MaterialRow> = materials
        .iter()
        .map(|material| match material {
            scene::Material::TwoSided { front, back } => MaterialRow {
                front: textures.model(front),
                back: Some(textures.model(back.as_deref().unwrap_or(front))),
            },
            one_sided => MaterialRow { front: textures.model(one_sided), back: None },
        })
        .collect();
    let (table, ids) = MaterialTable::new(&rows);
    (table, textures.table, ids)
}

struct Textures {
    table: TextureTable,
    /// Pictures that several materials share are stored once.
    seen: Vec<(scene::Texture, TextureId)>,
}

impl Textures {
    fn model(&mut self, material: &scene::Material) -> Model {
        match material {
            scene::Material::Diffuse { reflectance } => Model::Lambert { reflectance: self.add(reflectance) },
            scene::Material::Conductor { eta, k, specular_reflectance } => {
                Model::Conductor { eta: *eta, k: *k, reflectance: self.add(specular_reflectance) }
            }
            scene::Material::Dielectric {
                int_ior,
                ext_ior,
                specular_reflectance,
                specular_transmittance,
            } => Model::Dielectric {
                eta: int_ior / ext_ior,
                reflectance: self.add(specular_reflectance),
                transmittance: self.add(specular_transmittance),
            },
            scene::Material::Phong { diffuse_reflectance, specular_reflectance, exponent } => Model::Phong {
                diffuse: self.add(diffuse_reflectance),
                specular: self.add(specular_reflectance),
                exponent: *exponent,
            },
            // The description says that sides are not nested; if they are, the front is what is seen.
            scene::Material::TwoSided { front, .. } => self.model(front),
        }
    }

    fn add(&mut self, texture: &scene::Texture) -> TextureId {
        if let Some((_, id)) = self.seen.iter().find(|(seen, _)| same(seen, texture)) {
            return *id;
        }
        let id = self.table.add(match texture {
            scene::Texture::Constant(color) => Texture::Constant(*color),
            scene::Texture::Checkerboard { color0, color1, to_uv } => {
                Texture::Checkerboard { colors: [*color0, *color1], map: UvMap::new(*to_uv) }
            }
            scene::Texture::Bitmap { picture, filter, wrap, to_uv } => {
                Texture::Bitmap { bitmap: bitmap(picture, *filter, *wrap), map: UvMap::new(*to_uv) }
            }
        });
        self.seen.push((texture.clone(), id));
        id
    }
}

/// Equality without comparing texels: pictures are the same if they are one.
fn same(a: &scene::Texture, b: &scene::Texture) -> bool {
    use scene::Texture::Bitmap;
    match (a, b) {
        (
            Bitmap { picture: p, filter: f, wrap: w, to_uv: m },
            Bitmap { picture: q, filter: g, wrap: x, to_uv: n },
        ) => Arc::ptr_eq(p, q) && (f, w, m) == (g, x, n),
        (Bitmap { .. }, _) | (_, Bitmap { .. }) => false,
        _ => a == b,
    }
}

fn bitmap(picture: &Picture, filter: scene::Filter, wrap: scene::Wrap) -> Bitmap {
    let plane = |c: usize| picture.channels.get(c).or(picture.channels.first()).map(|c| c.samples.as_slice());
    let [r, g, b] = [plane(0), plane(1), plane(2)].map(Option::unwrap_or_default);
    Bitmap {
        texels: r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]).collect(),
        width: picture.width,
        height: picture.height,
        filter: match filter {
            scene::Filter::Bilinear => Filter::Bilinear,
            scene::Filter::Nearest => Filter::Nearest,
        },
        wrap: match wrap {
            scene::Wrap::Repeat => Wrap::Repeat,
            scene::Wrap::Mirror => Wrap::Mirror,
            scene::Wrap::Clamp => Wrap::Clamp,
        },
    }
}
