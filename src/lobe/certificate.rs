//! Is a model a reflection model? Five questions, each with a number and a verdict.

use glam::Vec3;
use rayon::prelude::*;

use super::{
    Albedo, Swatch,
    roughness::{ROUGHNESSES, with_roughness},
};
use crate::{
    compile::CompileError,
    material::proof::{Fit, Reflector, Worst, at, isotropy, reciprocity, sidak},
    simd::f32x8,
};

/// Pairs of directions for reciprocity; a tenth of them for each turn of isotropy.
const PAIRS: usize = 1_000_000;
/// Blocks of pairs, each with a seed of its own: what is found does not depend on the number of threads.
const BLOCKS: usize = 50;
/// Samples an angle for the density.
const SAMPLES: usize = 1_000_000;
/// Relative difference beyond which f(a, b) is not f(b, a).
const NOT_RECIPROCAL: f32 = 1e-2;
/// Share of pairs that rounding may break: near total reflection and in the tails of narrow lobes, single
/// precision keeps two digits.
const ROUNDED: f64 = 1e-3;
/// Relative difference beyond which a turned f is another one.
const NOT_ISOTROPIC: f32 = 2e-2;
/// What a sum of weights may exceed 1 by: the noise of the lattice.
const ALBEDO_NOISE: f64 = 3e-3;
/// What ∫pdf may miss beyond the noise of samples.
const DENSITY_NOISE: f64 = 3e-3;
/// Probability with which a right model fails the χ² of all angles together.
const LEVEL: f64 = 0.01;
/// Degrees from the normal of the viewer, and below the surface for what transmits.
const ABOVE: [f32; 7] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0];
const BELOW: [f32; 4] = [110.0, 135.0, 160.0, 180.0];

/// What was asked, what was found, and what it means.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The property.
    pub property: &'static str,
    /// How it was looked for.
    pub how: String,
    /// What was found.
    pub found: String,
    /// `None` where there is no right and wrong.
    pub passed: Option<bool>,
}

/// The answers.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// One a question.
    pub rows: Vec<Row>,
}

impl Certificate {
    /// Asks a material, at its own roughness and at others, on the current rayon pool.
    ///
    /// # Errors
    /// [`CompileError`], as for a scene.
    pub fn new(swatch: &Swatch) -> Result<Self, CompileError> {
        let mut family = Vec::new();
        for alpha in ROUGHNESSES {
            if let Some(material) = with_roughness(swatch.material(), alpha) {
                family.push((alpha, Swatch::new(material)?));
            }
        }
        let mut certificate = Self::of(swatch);
        if !family.is_empty() {
            certificate.rows.insert(2, energy_over_roughness(&family));
        }
        Ok(certificate)
    }

    /// Asks any model.
    pub fn of<M: Reflector<f32x8> + Sync>(model: &M) -> Self {
        let angles: Vec<f32> =
            ABOVE.into_iter().chain(BELOW.into_iter().filter(|_| model.transmits())).collect();
        let fits: Vec<(f32, Fit)> = angles
            .into_par_iter()
            .map(|degrees| (degrees, Fit::new(model, at(degrees), SAMPLES, degrees as u64 + 1)))
            .collect();
        let mut rows = vec![reciprocal(model), energy(model), isotropic(model)];
        rows.extend([density(&fits), sampling(&fits)]);
        Self { rows }
    }

    /// Does every row that can fail pass?
    pub fn passed(&self) -> bool {
        self.rows.iter().all(|row| row.passed != Some(false))
    }
}

fn degrees(w: Vec3) -> f32 {
    w.z.clamp(-1.0, 1.0).acos().to_degrees()
}

fn reciprocal<M: Reflector<f32x8> + Sync>(model: &M) -> Row {
    let seeds = (0..BLOCKS as u64).into_par_iter();
    let blocks = seeds.map(|seed| reciprocity(model, PAIRS / BLOCKS, NOT_RECIPROCAL, seed));
    // Blocks in their order: the first of equals is told.
    let all = blocks.collect::<Vec<_>>().into_iter().fold(Worst::default(), Worst::and);
    let most = format!(
        "at most by {:.3} %, at {:.0}° and {:.0}°",
        100.0 * all.difference,
        degrees(all.a),
        degrees(all.b)
    );
    Row {
        property: "reciprocity",
        how: "10⁶ pairs".into(),
        found: match (all.difference, all.broken) {
            (0.0, _) => "f(a, b) = f(b, a) everywhere".into(),
            (_, 0) => format!("f(a, b) and f(b, a) differ {most}"),
            _ => format!("{:.3} % of pairs differ by over 1 %, {most}", 100.0 * share(&all)),
        },
        passed: Some(share(&all) <= ROUNDED),
    }
}

/// Broken pairs among those that reflect.
fn share(all: &Worst) -> f64 {
    all.broken as f64 / all.lit.max(1) as f64
}

/// The greatest albedo over 90 angles.
fn greatest<M: Reflector<f32x8> + Sync>(model: &M) -> Albedo {
    let albedo: Vec<Albedo> = (0..90).into_par_iter().map(|i| Albedo::new(model, i as f32)).collect();
    let first = albedo[0];
    albedo.into_iter().fold(first, |a, b| if b.most() > a.most() { b } else { a })
}

fn energy<M: Reflector<f32x8> + Sync>(model: &M) -> Row {
    let most = greatest(model);
    Row {
        property: "albedo ≤ 1",
        how: "90 angles".into(),
        found: format!("{:.4} at {}°", most.most(), most.angle),
        passed: Some(most.most() <= 1.0 + ALBEDO_NOISE),
    }
}

fn energy_over_roughness(family: &[(f32, Swatch)]) -> Row {
    let most = family.iter().map(|(alpha, swatch)| (*alpha, greatest(swatch)));
    let most = most.reduce(|a, b| if b.1.most() > a.1.most() { b } else { a });
    let (alpha, albedo) = most.unwrap_or((0.0, Albedo::default()));
    let range = (ROUGHNESSES[0], ROUGHNESSES[ROUGHNESSES.len() - 1]);
    Row {
        property: "albedo ≤ 1",
        how: format!("roughness {} to {}", range.0, range.1),
        found: format!("{:.4} at {}°, roughness {alpha}", albedo.most(), albedo.angle),
        passed: Some(albedo.most() <= 1.0 + ALBEDO_NOISE),
    }
}

fn isotropic<M: Reflector<f32x8>>(model: &M) -> Row {
    let found = match isotropy(model, PAIRS / 10, NOT_ISOTROPIC, 1) {
        None => "isotropic".into(),
        Some(turned) => format!(
            "breaks within a turn of {}°: f changes by {:.0} %",
            turned.degrees,
            100.0 * turned.difference.min(1.0)
        ),
    };
    Row { property: "isotropy", how: "10⁵ pairs, turned".into(), found, passed: None }
}

fn density(fits: &[(f32, Fit)]) -> Row {
    let worst = fits.iter().fold(&fits[0], |a, b| if b.1.excess() > a.1.excess() { b } else { a });
    let (degrees, fit) = worst;
    let delta = 1.0 - fit.share - fit.lost;
    let mut found = format!("∫pdf = {:.4} at {degrees}°", fit.density);
    for (share, what) in [(delta, "in delta lobes"), (fit.lost, "of the samples carry nothing")] {
        if share > 1e-6 {
            found += &format!(", {share:.4} {what}");
        }
    }
    Row {
        property: "∫pdf = 1",
        how: format!("{} angles", fits.len()),
        found: found + &format!(": {:.4} in all", fit.density + delta.max(0.0) + fit.lost),
        passed: Some(fit.excess() <= DENSITY_NOISE),
    }
}

fn sampling(fits: &[(f32, Fit)]) -> Row {
    let level = sidak(LEVEL, fits.len());
    let (degrees, fit) = fits.iter().fold(&fits[0], |a, b| if b.1.p < a.1.p { b } else { a });
    Row {
        property: "samples follow pdf",
        how: format!("χ², {} angles, 10⁶ each", fits.len()),
        found: format!(
            "p = {:.4} at {degrees}° (χ² {:.0}, {} bins); each > {level:.4}",
            fit.p,
            fit.chi_squared,
            fit.freedom + 1.0
        ),
        passed: Some(fit.p > level),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        load::read_material,
        material::Sample,
        math::{INV_PI, pow, warp},
        simd::{Mask, Real, Vector3},
    };

    type Evaluated = (Vector3<f32x8>, f32x8);

    /// A model of a sloppy day: Lambert's sampling, and whatever f and density.
    struct Sloppy(fn(Vector3<f32x8>, Vector3<f32x8>) -> Evaluated);

    impl Reflector<f32x8> for Sloppy {
        fn eval_pdf(&self, wo: Vector3<f32x8>, wi: Vector3<f32x8>) -> Evaluated {
            let (f, pdf) = (self.0)(wo, wi);
            let above = wo.z.gt(f32x8::zero()) & wi.z.gt(f32x8::zero());
            (f.only(above), pdf.only(above))
        }

        fn sample(&self, wo: Vector3<f32x8>, _: f32x8, u: (f32x8, f32x8)) -> Sample<f32x8> {
            let wi = warp::cosine_hemisphere(u.0, u.1);
            let (f, pdf) = self.eval_pdf(wo, wi);
            let valid = pdf.gt(f32x8::zero());
            let weight = f.scale(f32x8::one() / f32x8::select(valid, pdf, f32x8::one()));
            Sample { wi, weight, pdf, eta: f32x8::one(), delta: Mask::splat(false), valid }
        }

        fn transmits(&self) -> bool {
            false
        }
    }

    fn cosine(wi: Vector3<f32x8>) -> f32x8 {
        warp::cosine_hemisphere_pdf(wi.z)
    }

    /// The properties that fail.
    fn failures(f: fn(Vector3<f32x8>, Vector3<f32x8>) -> Evaluated) -> Vec<&'static str> {
        let rows = Certificate::of(&Sloppy(f)).rows.into_iter();
        rows.filter(|row| row.passed == Some(false)).map(|row| row.property).collect()
    }

    fn grey(x: f32x8) -> Vector3<f32x8> {
        Vector3 { x, y: x, z: x }
    }

    #[test]
    fn an_honest_model_passes() {
        assert_eq!(failures(|_, wi| (grey(cosine(wi)), cosine(wi))), [""; 0]);
    }

    #[test]
    fn the_slide_form_of_phong_is_not_reciprocal() {
        // cosⁿα stands in place of f cos θ_i.
        let broken = |wo: Vector3<f32x8>, wi: Vector3<f32x8>| {
            let alpha = (wo.z * wi.z - wo.x * wi.x - wo.y * wi.y).max(f32x8::zero());
            (
                grey(pow(alpha, f32x8::splat(5.0)).only(alpha.gt(f32x8::zero())) * f32x8::splat(0.2)),
                cosine(wi),
            )
        };
        assert_eq!(failures(broken), ["reciprocity"]);
    }

    #[test]
    fn light_from_nowhere_is_found() {
        assert_eq!(failures(|_, wi| (grey(cosine(wi) * f32x8::splat(1.1)), cosine(wi))), ["albedo ≤ 1"]);
    }

    #[test]
    fn a_density_of_less_than_one_is_found() {
        let short = failures(|_, wi| (grey(cosine(wi) * f32x8::splat(0.5)), cosine(wi) * f32x8::splat(0.97)));
        assert_eq!(short, ["∫pdf = 1", "samples follow pdf"]);
    }

    #[test]
    fn samples_of_another_density_are_found() {
        let uniform =
            |_, wi: Vector3<f32x8>| (grey(wi.z * f32x8::splat(0.5 * INV_PI)), f32x8::splat(0.5 * INV_PI));
        assert_eq!(failures(uniform), ["samples follow pdf"]);
    }

    #[test]
    fn a_brushed_metal_passes_and_is_told_to_be_brushed() {
        let (material, _) = read_material("roughconductor:alpha_u=0.1,alpha_v=0.4,material=Al").unwrap();
        let certificate = Certificate::new(&Swatch::new(material).unwrap()).unwrap();
        assert!(certificate.passed(), "{certificate:#?}");
        let told =
            certificate.rows.iter().find(|row| row.property == "isotropy").map(|row| row.found.as_str());
        assert!(told.is_some_and(|found| found.starts_with("breaks within a turn of 1°")), "{told:?}");
    }
}
