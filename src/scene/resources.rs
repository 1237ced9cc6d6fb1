//! What a description holds by reference, each thing once, however often it is used.

use std::sync::Arc;

use super::{
    Emitter, Geometry, Material, MerlTable, Mesh, Metal, Principled, Roughness, SceneDescription, Texture,
};
use crate::picture::Picture;

/// Meshes, pictures and tables.
#[derive(Debug, Default)]
pub struct Resources<'a> {
    /// Of shapes, those of groups included.
    pub meshes: Vec<&'a Mesh>,
    /// Of textures.
    pub textures: Vec<&'a Picture>,
    /// Of emitters.
    pub environments: Vec<&'a Picture>,
    /// Of measured materials.
    pub tables: Vec<&'a MerlTable>,
}

impl SceneDescription {
    /// Everything that is shared.
    pub fn resources(&self) -> Resources<'_> {
        let grouped = self.groups.iter().flat_map(|group| &group.shapes);
        let meshes = self.shapes.iter().chain(grouped).filter_map(|shape| match &shape.geometry {
            Geometry::Mesh { mesh, .. } => Some(mesh),
            _ => None,
        });
        let mut parts = Parts::default();
        self.materials.iter().for_each(|material| parts.add(material));
        let pictures = parts.textures.iter().filter_map(|texture| match texture {
            Texture::Bitmap { picture, .. } => Some(picture),
            _ => None,
        });
        let environments = self.emitters.iter().filter_map(|emitter| match emitter {
            Emitter::Envmap { picture, .. } => Some(picture),
            _ => None,
        });
        Resources {
            meshes: distinct(meshes),
            textures: distinct(pictures),
            environments: distinct(environments),
            tables: distinct(parts.tables.iter().copied()),
        }
    }
}

fn distinct<'a, T>(shared: impl Iterator<Item = &'a Arc<T>>) -> Vec<&'a T> {
    let mut found: Vec<&Arc<T>> = shared.collect();
    found.sort_by_key(|shared| Arc::as_ptr(shared));
    found.dedup_by_key(|shared| Arc::as_ptr(shared));
    found.into_iter().map(|shared| &**shared).collect()
}

/// What materials are made of.
#[derive(Default)]
struct Parts<'a> {
    textures: Vec<&'a Texture>,
    tables: Vec<&'a Arc<MerlTable>>,
}

impl<'a> Parts<'a> {
    fn add(&mut self, material: &'a Material) {
        match material {
            Material::Diffuse { reflectance } | Material::Toon { reflectance, .. } => {
                self.textures.push(reflectance);
            }
            Material::Conductor { metal, specular_reflectance } => {
                self.add_metal(metal);
                self.textures.push(specular_reflectance);
            }
            Material::RoughConductor { roughness, metal, specular_reflectance } => {
                self.add_roughness(roughness);
                self.add_metal(metal);
                self.textures.push(specular_reflectance);
            }
            Material::Dielectric { specular_reflectance, specular_transmittance, .. } => {
                self.textures.extend([specular_reflectance, specular_transmittance]);
            }
            Material::RoughDielectric { roughness, specular_reflectance, specular_transmittance, .. } => {
                self.add_roughness(roughness);
                self.textures.extend([specular_reflectance, specular_transmittance]);
            }
            Material::Plastic { roughness, diffuse_reflectance, specular_reflectance, .. } => {
                self.textures.extend(roughness.iter().map(|(_, alpha)| alpha));
                self.textures.extend([diffuse_reflectance, specular_reflectance]);
            }
            Material::Principled(principled) => self.add_principled(principled),
            Material::Measured { table } => self.tables.push(table),
            Material::Phong { diffuse_reflectance, specular_reflectance, exponent } => {
                self.textures.extend([diffuse_reflectance, specular_reflectance, exponent]);
            }
            Material::Ward { diffuse_reflectance, specular_reflectance, alpha_u, alpha_v } => {
                self.textures.extend([diffuse_reflectance, specular_reflectance, alpha_u, alpha_v]);
            }
            Material::TwoSided { front, back } => {
                self.add(front);
                back.iter().for_each(|back| self.add(back));
            }
            Material::Blend { weight, nested } => {
                self.textures.push(weight);
                nested.iter().for_each(|material| self.add(material));
            }
            Material::Mask { opacity: texture, nested }
            | Material::BumpMap { height: texture, nested, .. }
            | Material::NormalMap { normals: texture, nested, .. } => {
                self.textures.push(texture);
                self.add(nested);
            }
        }
    }

    fn add_metal(&mut self, Metal { eta, k }: &'a Metal) {
        self.textures.extend([eta, k]);
    }

    fn add_roughness(&mut self, Roughness { alpha_u, alpha_v, .. }: &'a Roughness) {
        self.textures.extend([alpha_u, alpha_v]);
    }

    fn add_principled(&mut self, principled: &'a Principled) {
        let Principled {
            base_color,
            roughness,
            anisotropic,
            metallic,
            spec_trans,
            eta: _,
            spec_tint,
            sheen,
            sheen_tint,
            flatness,
            clearcoat,
            clearcoat_gloss,
        } = principled;
        self.textures.extend([base_color, roughness, anisotropic, metallic, spec_trans, spec_tint]);
        self.textures.extend([sheen, sheen_tint, flatness, clearcoat, clearcoat_gloss]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Filter, Wrap};

    fn texture(picture: &Arc<Picture>) -> Texture {
        let (filter, wrap, to_uv) = (Filter::Bilinear, Wrap::Repeat, glam::DAffine2::IDENTITY);
        Texture::Bitmap { picture: Arc::clone(picture), filter, wrap, to_uv }
    }

    #[test]
    fn what_is_shared_counts_once_wherever_it_is() {
        let picture = |width| Arc::new(Picture { width, height: 1, ..Picture::default() });
        let (one, other) = (picture(1), picture(2));
        let diffuse = |picture| Material::Diffuse { reflectance: texture(picture) };
        let blend =
            Material::Blend { weight: texture(&other), nested: [diffuse(&one), diffuse(&one)].into() };
        let hidden = Material::TwoSided { front: Material::default().into(), back: Some(Box::new(blend)) };
        let sky = Emitter::Envmap { picture: picture(3), scale: 1.0, to_world: glam::DMat3::IDENTITY };
        let scene = SceneDescription {
            materials: vec![diffuse(&one), hidden],
            emitters: vec![sky],
            ..SceneDescription::default()
        };
        let Resources { textures, environments, .. } = scene.resources();
        let mut widths: Vec<u32> = textures.iter().map(|picture| picture.width).collect();
        widths.sort_unstable();
        assert_eq!((widths, environments.len()), (vec![1, 2], 1));
    }
}
