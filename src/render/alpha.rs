//! The share of each pixel in which there is something.
//!
//! A pass of its own, by the same camera rays: what light does never has to ask how opaque the picture is.

use super::integrator::{Integrator, Line, Outgoing, Path};
use super::vertex::Vertex;
use crate::compile::Scene;
use crate::scene;
use crate::simd::Real;

/// 1 where a camera ray hits a surface, or sees an environment that is shown.
pub(super) struct Alpha {
    /// Is what is infinitely far away something?
    environment: bool,
}

impl Alpha {
    /// Of the picture that the scene's integrator makes.
    pub(super) fn of(scene: &Scene) -> Self {
        let shown = matches!(scene.integrator, scene::Integrator::Path { hide_emitters: false, .. });
        Self { environment: shown && !scene.environments.is_empty() }
    }
}

impl Integrator for Alpha {
    fn channels(&self) -> Vec<String> {
        vec!["A".into()]
    }

    fn shadow_rays(&self, _: &Scene) -> usize {
        0
    }

    fn miss<R: Real>(&self, _: &Scene, _: &Path<R>, _: Line<R>, out: &mut impl Outgoing<R>) {
        out.add(0, if self.environment { R::one() } else { R::zero() });
    }

    fn shade<R: Real>(&self, _: &Scene, _: &Vertex<'_, R>, out: &mut impl Outgoing<R>) {
        out.add(0, R::one());
    }
}
