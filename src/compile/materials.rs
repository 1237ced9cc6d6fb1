//! Described materials to rows of the table: trees of wrappers become lists of layers.

use std::sync::Arc;

use super::attributes::AttributedMeshes;
use crate::material::{
    Coat, CoatRange, Factor, Layer, MaterialId, MaterialRow, MaterialTable, MerlTable, Model, Ramp, Step,
    Tables, diffuse_reflectance,
};
use crate::picture::Picture;
use crate::scene::{self, Distribution, Material};
use crate::texture::{Bitmap, Filter, Texture, TextureId, TextureTable, UvMap, Wrap};

/// The table, its textures, and for each described material its id, and whether it is different at other (u, v).
pub(super) fn compile(
    materials: &[Material],
    meshes: &AttributedMeshes,
) -> (MaterialTable, TextureTable, Vec<(MaterialId, bool)>) {
    let mut compiler = Compiler {
        meshes,
        textures: TextureTable::default(),
        varies: false,
        seen: vec![],
        coats: vec![],
        ramps: vec![],
        measured: vec![],
    };
    let row = |material| {
        compiler.varies = false;
        (compiler.row(material), compiler.varies)
    };
    let (rows, vary): (_, Vec<bool>) = materials.iter().map(row).unzip();
    let (table, ids) = {
        let coats = compiler.coats.into_iter().map(|(_, coat)| coat).collect();
        MaterialTable::new(rows, Tables { coats, ramps: compiler.ramps, measured: compiler.measured })
    };
    (table, compiler.textures, ids.into_iter().zip(vary).collect())
}

struct Compiler<'m> {
    meshes: &'m AttributedMeshes,
    textures: TextureTable,
    /// Has a texture been added that is not the same everywhere?
    varies: bool,
    /// Pictures that several materials share are stored once.
    seen: Vec<(scene::Texture, TextureId)>,
    coats: Vec<(CoatKey, CoatRange)>,
    ramps: Vec<Arc<Ramp>>,
    measured: Vec<Arc<MerlTable>>,
}

/// Distribution, α and η; no α is any α.
type CoatKey = (Distribution, Option<f32>, f32);

/// How a layer has been reached.
#[derive(Clone, Default)]
struct Way {
    factors: Vec<Factor>,
    steps: Vec<Step>,
}

impl Way {
    fn step(&self, step: Step) -> Self {
        let mut way = self.clone();
        way.steps.push(step);
        way
    }

    fn times(&self, texture: TextureId, complement: bool) -> Self {
        let mut way = self.clone();
        way.factors.push(Factor { texture, complement });
        way
    }

    /// Light that passes straight through doesn't see where the normal leans.
    fn without_relief(mut self) -> Self {
        self.steps.retain(|step| !matches!(step, Step::Bump { .. } | Step::Normal { .. }));
        self
    }
}

impl Compiler<'_> {
    fn row(&mut self, material: &Material) -> MaterialRow {
        let mut others = Vec::new();
        self.layers(material, &Way::default(), &mut others);
        // A tree has at least one leaf; what is seen first gives the row its kind.
        let first = others.remove(0);
        MaterialRow { first, others }
    }

    fn layers(&mut self, material: &Material, way: &Way, out: &mut Vec<Layer>) {
        match material {
            Material::TwoSided { front, back: None } => self.layers(front, &way.step(Step::Turn), out),
            Material::TwoSided { front, back: Some(back) } => {
                self.layers(front, &way.step(Step::Front), out);
                self.layers(back, &way.step(Step::Back), out);
            }
            Material::Mask { opacity, nested } => {
                let opacity = self.add(opacity);
                self.layers(nested, &way.times(opacity, false), out);
                let Way { factors, steps } = way.times(opacity, true).without_relief();
                out.push(Layer { model: Model::Transparent, factors, steps });
            }
            Material::Blend { weight, nested } => {
                let weight = self.add(weight);
                self.layers(&nested[0], &way.times(weight, true), out);
                self.layers(&nested[1], &way.times(weight, false), out);
            }
            Material::BumpMap { height, scale, relief, nested } => {
                let texture = self.add(height);
                self.layers(nested, &way.step(Step::Bump { texture, scale: *scale, relief: *relief }), out);
            }
            Material::NormalMap { normals, relief, nested } => {
                let texture = self.add(normals);
                self.layers(nested, &way.step(Step::Normal { texture, relief: *relief }), out);
            }
            leaf => {
                let Way { factors, steps } = way.clone();
                out.push(Layer { model: self.model(leaf), factors, steps });
            }
        }
    }

    fn model(&mut self, material: &Material) -> Model {
        match material {
            Material::Diffuse { reflectance } => Model::Lambert { reflectance: self.add(reflectance) },
            Material::Conductor { metal, specular_reflectance } => Model::Conductor {
                eta: self.add(&metal.eta),
                k: self.add(&metal.k),
                reflectance: self.add(specular_reflectance),
            },
            Material::RoughConductor { roughness, metal, specular_reflectance } => Model::RoughConductor {
                distribution: roughness.distribution,
                alpha_u: self.add(&roughness.alpha_u),
                alpha_v: self.add(&roughness.alpha_v),
                eta: self.add(&metal.eta),
                k: self.add(&metal.k),
                reflectance: self.add(specular_reflectance),
            },
            Material::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance } => {
                Model::Dielectric {
                    eta: int_ior / ext_ior,
                    reflectance: self.add(specular_reflectance),
                    transmittance: self.add(specular_transmittance),
                }
            }
            Material::RoughDielectric {
                roughness,
                int_ior,
                ext_ior,
                specular_reflectance,
                specular_transmittance,
            } => Model::RoughDielectric {
                distribution: roughness.distribution,
                alpha_u: self.add(&roughness.alpha_u),
                alpha_v: self.add(&roughness.alpha_v),
                eta: int_ior / ext_ior,
                reflectance: self.add(specular_reflectance),
                transmittance: self.add(specular_transmittance),
            },
            Material::Plastic {
                roughness,
                int_ior,
                ext_ior,
                diffuse_reflectance: diffuse,
                specular_reflectance: specular,
                nonlinear,
            } => {
                let (diffuse, specular) = (self.add(diffuse), self.add(specular));
                self.plastic(roughness.as_ref(), int_ior / ext_ior, (diffuse, specular), *nonlinear)
            }
            Material::Principled(p) => Model::Principled {
                base_color: self.add(&p.base_color),
                roughness: self.add(&p.roughness),
                anisotropic: self.add(&p.anisotropic),
                metallic: self.add(&p.metallic),
                spec_trans: self.add(&p.spec_trans),
                eta: p.eta,
                spec_tint: self.add(&p.spec_tint),
                sheen: self.add(&p.sheen),
                sheen_tint: self.add(&p.sheen_tint),
                flatness: self.add(&p.flatness),
                clearcoat: self.add(&p.clearcoat),
                clearcoat_gloss: self.add(&p.clearcoat_gloss),
            },
            Material::Measured { table } => {
                let same = |known: &Arc<MerlTable>| Arc::ptr_eq(known, table);
                let place = self.measured.iter().position(same).unwrap_or_else(|| {
                    self.measured.push(Arc::clone(table));
                    self.measured.len() - 1
                });
                Model::Measured { table: place as u32 }
            }
            Material::Phong { diffuse_reflectance, specular_reflectance, exponent } => Model::Phong {
                diffuse: self.add(diffuse_reflectance),
                specular: self.add(specular_reflectance),
                exponent: self.add(exponent),
            },
            Material::Ward { diffuse_reflectance, specular_reflectance, alpha_u, alpha_v } => Model::Ward {
                diffuse: self.add(diffuse_reflectance),
                specular: self.add(specular_reflectance),
                alpha_u: self.add(alpha_u),
                alpha_v: self.add(alpha_v),
            },
            Material::Toon { reflectance, ramp } => {
                let place = self.ramps.iter().position(|known| known == ramp).unwrap_or_else(|| {
                    self.ramps.push(Arc::clone(ramp));
                    self.ramps.len() - 1
                });
                Model::Toon { reflectance: self.add(reflectance), ramp: place as u32 }
            }
            // Wrappers have been opened by `layers`.
            Material::TwoSided { .. }
            | Material::Mask { .. }
            | Material::Blend { .. }
            | Material::BumpMap { .. }
            | Material::NormalMap { .. } => Model::Transparent,
        }
    }

    fn plastic(
        &mut self,
        roughness: Option<&(Distribution, scene::Texture)>,
        eta: f32,
        (diffuse, specular): (TextureId, TextureId),
        nonlinear: bool,
    ) -> Model {
        let Some((distribution, alpha)) = roughness else {
            return Model::Plastic {
                diffuse,
                specular,
                eta,
                internal: diffuse_reflectance(1.0 / eta),
                nonlinear,
            };
        };
        let constant = match alpha {
            scene::Texture::Constant(alpha) => Some(alpha.x),
            _ => None,
        };
        let key = (*distribution, constant, eta);
        let place = self.coats.iter().position(|(known, _)| *known == key).unwrap_or_else(|| {
            let coats = match constant {
                Some(alpha) => CoatRange::from(Coat::new(*distribution, alpha, eta)),
                None => CoatRange::of_any_roughness(*distribution, eta),
            };
            self.coats.push((key, coats));
            self.coats.len() - 1
        });
        let (distribution, alpha) = (*distribution, self.add(alpha));
        Model::RoughPlastic { distribution, alpha, coat: place as u32, eta, diffuse, specular, nonlinear }
    }

    fn add(&mut self, texture: &scene::Texture) -> TextureId {
        self.varies |= !matches!(texture, scene::Texture::Constant(_));
        if let Some((_, id)) = self.seen.iter().find(|(seen, _)| same(seen, texture)) {
            return *id;
        }
        let id = self.textures.add(match texture {
            scene::Texture::Constant(color) => Texture::Constant(*color),
            scene::Texture::Checkerboard { color0, color1, to_uv } => {
                Texture::Checkerboard { colors: [*color0, *color1], map: UvMap::new(*to_uv) }
            }
            scene::Texture::Bitmap { picture, filter, wrap, to_uv } => {
                Texture::Bitmap { bitmap: bitmap(picture, *filter, *wrap), map: UvMap::new(*to_uv) }
            }
            scene::Texture::MeshAttribute { name, scale } => {
                Texture::MeshAttribute(self.meshes.texture(name, *scale))
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
