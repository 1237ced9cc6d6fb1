//! All materials of a scene: parameters in columns, ids grouped by kind.
//!
//! Ids are handed out kind by kind, so that one stable sort by id makes both the runs of a kernel (a
//! kind) and the runs of its constants (an id).

use glam::Vec3;

use super::{Bsdf, Conductor, Dielectric, Lambert, Phong};
use crate::simd::{Real, Vector3};
use crate::texture::{TextureId, TextureTable};

/// Which material; ids of one kind stand together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialId(pub u32);

/// A model and where its parameters come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Model {
    /// [`Lambert`].
    Lambert {
        /// ρ.
        reflectance: TextureId,
    },
    /// [`Phong`].
    Phong {
        /// ρ_d.
        diffuse: TextureId,
        /// ρ_s.
        specular: TextureId,
        /// n.
        exponent: f32,
    },
    /// [`Conductor`].
    Conductor {
        /// Real part of the index of refraction.
        eta: Vec3,
        /// Imaginary part.
        k: Vec3,
        /// Factor.
        reflectance: TextureId,
    },
    /// [`Dielectric`].
    Dielectric {
        /// n_int/n_ext.
        eta: f32,
        /// Factor on reflection.
        reflectance: TextureId,
        /// Factor on refraction.
        transmittance: TextureId,
    },
}

impl Model {
    fn kind(&self) -> u32 {
        match self {
            Self::Lambert { .. } => 0,
            Self::Phong { .. } => 1,
            Self::Conductor { .. } => 2,
            Self::Dielectric { .. } => 3,
        }
    }

    /// The model with its parameters at each lane's (u, v).
    #[inline]
    pub fn fetch<R: Real>(&self, textures: &TextureTable, uv: (R, R)) -> Bsdf<R> {
        match *self {
            Self::Lambert { reflectance } => {
                Bsdf::Lambert(Lambert { reflectance: textures.fetch(reflectance, uv) })
            }
            Self::Phong { diffuse, specular, exponent } => Bsdf::Phong(Phong {
                diffuse: textures.fetch(diffuse, uv),
                specular: textures.fetch(specular, uv),
                exponent: R::splat(exponent),
            }),
            Self::Conductor { eta, k, reflectance } => Bsdf::Conductor(Conductor {
                eta: Vector3::splat(eta),
                k: Vector3::splat(k),
                reflectance: textures.fetch(reflectance, uv),
            }),
            Self::Dielectric { eta, reflectance, transmittance } => Bsdf::Dielectric(Dielectric {
                eta: R::splat(eta),
                reflectance: textures.fetch(reflectance, uv),
                transmittance: textures.fetch(transmittance, uv),
            }),
        }
    }
}

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialRow {
    /// What the side of the normal is.
    pub front: Model,
    /// What the other side is, shaded as if it faced the viewer; `None` leaves it to the model, which is
    /// black there or glass.
    pub back: Option<Model>,
}

/// The materials of a scene.
#[derive(Clone, Debug, Default)]
pub struct MaterialTable {
    rows: Vec<MaterialRow>,
}

impl MaterialTable {
    /// A table of these rows, and the id of each in the order given.
    pub fn new(rows: &[MaterialRow]) -> (Self, Vec<MaterialId>) {
        let mut order: Vec<usize> = (0..rows.len()).collect();
        order.sort_by_key(|&i| rows[i].front.kind());
        let mut ids = vec![MaterialId(0); rows.len()];
        for (place, &i) in order.iter().enumerate() {
            ids[i] = MaterialId(place as u32);
        }
        (Self { rows: order.into_iter().map(|i| rows[i]).collect() }, ids)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The row of an id of this table.
    #[inline]
    pub fn row(&self, id: MaterialId) -> &MaterialRow {
        &self.rows[id.0 as usize]
    }
}
