//! All materials of a scene: layers of models, ids grouped by kind.
//!
//! Ids are handed out kind by kind, so that one stable sort by id makes both the runs of a kernel (a
//! kind) and the runs of its constants (an id).

use std::sync::Arc;

use super::{Appearance, CoatRange, MerlTable, Model, Ramp, appearance::Point};
use crate::simd::Real;
use crate::texture::{TextureId, TextureTable};

/// Which material; ids of one kind stand together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialId(pub u32);

/// What changes directions between the surface and a model, outermost first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// The side seen is the front.
    Turn,
    /// The model is there on the side of the normal only.
    Front,
    /// The model is there on the other side only, and faces that way.
    Back,
    /// The normal leans by the slope of a height.
    Bump {
        /// Height over uv.
        texture: TextureId,
        /// Factor on the height, in units of the scene.
        scale: f32,
        /// What is done where it leans far.
        relief: Relief,
    },
    /// The normal is given in the surface's frame, (n + 1)/2.
    Normal {
        /// Components as a colour.
        texture: TextureId,
        /// What is done where it leans far.
        relief: Relief,
    },
}

/// What is done about normals that lean on a surface that does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Relief {
    /// A normal that looks away from the viewer leans to the other side instead.
    pub flips: bool,
    /// Light at grazing angles is shadowed as by microfacets, not cut off at the horizon \[CLS19\].
    pub shadows: bool,
}

impl Default for Relief {
    fn default() -> Self {
        Self { flips: true, shadows: true }
    }
}

/// A share of light: a texture's value, or what it leaves of 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factor {
    /// A number in [0, 1] over uv.
    pub texture: TextureId,
    /// 1 − value.
    pub complement: bool,
}

/// One model of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// How it reflects.
    pub model: Model,
    /// Its weight is their product. At every point and from every side, the weights of a material's
    /// layers add up to 1.
    pub factors: Vec<Factor>,
    /// From the surface to the model.
    pub steps: Vec<Step>,
}

/// A row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialRow {
    /// What is seen of it.
    pub first: Layer,
    /// And what else.
    pub others: Vec<Layer>,
}

impl MaterialRow {
    fn layers(&self) -> impl Iterator<Item = &Layer> {
        [&self.first].into_iter().chain(&self.others)
    }

    /// Does the material need the tangents of the surface?
    fn is_oriented(&self) -> bool {
        let leans = |step: &Step| matches!(step, Step::Bump { .. } | Step::Normal { .. });
        self.layers().any(|layer| layer.model.is_oriented() || layer.steps.iter().any(leans))
    }
}

/// The materials of a scene.
#[derive(Clone, Debug, Default)]
pub struct MaterialTable {
    rows: Vec<MaterialRow>,
    /// By row: does it need tangents?
    oriented: Vec<bool>,
    tables: Tables,
}

/// What models look up; they name places in it.
#[derive(Clone, Debug, Default)]
pub struct Tables {
    /// Of rough plastics.
    pub coats: Vec<CoatRange>,
    /// Of toons.
    pub ramps: Vec<Arc<Ramp>>,
    /// Of measured materials.
    pub measured: Vec<Arc<MerlTable>>,
}

impl MaterialTable {
    /// A table of these rows, whose models name these tables, and the id of each row in the order given.
    pub fn new(rows: Vec<MaterialRow>, tables: Tables) -> (Self, Vec<MaterialId>) {
        let mut order: Vec<usize> = (0..rows.len()).collect();
        order.sort_by_key(|&i| rows[i].first.model.kind());
        let mut ids = vec![MaterialId(0); rows.len()];
        for (place, &i) in order.iter().enumerate() {
            ids[i] = MaterialId(place as u32);
        }
        let mut rows: Vec<Option<MaterialRow>> = rows.into_iter().map(Some).collect();
        let rows: Vec<MaterialRow> = order.into_iter().filter_map(|i| rows[i].take()).collect();
        let oriented = rows.iter().map(MaterialRow::is_oriented).collect();
        (Self { rows, oriented, tables }, ids)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Must [`Point::tangents`] be those of the surface, and its frame along the first of them?
    #[inline]
    pub fn is_oriented(&self, id: MaterialId) -> bool {
        self.oriented[id.0 as usize]
    }

    /// What a material looks like at some points.
    #[inline(always)]
    pub fn appearance<'t, R: Real>(
        &'t self,
        id: MaterialId,
        textures: &TextureTable,
        point: &Point<R>,
    ) -> Appearance<'t, R> {
        let MaterialRow { first, others } = &self.rows[id.0 as usize];
        let fetch = |layer| {
            let model = |layer: &Layer| layer.model.fetch(&self.tables, textures, point.uv);
            point.place(|| model(layer), layer, textures)
        };
        Appearance::new(fetch(first), others.iter().map(fetch).collect())
    }
}
