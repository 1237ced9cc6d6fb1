use glam::Vec3;

use super::*;
use crate::material::{Bsdf, proof};

fn base() -> Principled<f32> {
    Principled {
        base_color: Vec3::new(0.8, 0.4, 0.1).into(),
        roughness: 0.5,
        anisotropic: 0.0,
        metallic: 0.0,
        spec_trans: 0.0,
        eta: 1.5,
        spec_tint: 0.0,
        sheen: 0.0,
        sheen_tint: 0.0,
        flatness: 0.0,
        clearcoat: 0.0,
        clearcoat_gloss: 0.0,
    }
}

/// η of Mitsuba's `specular`.
fn eta(specular: f32) -> f32 {
    2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0
}

fn metal() -> Principled<f32> {
    Principled { metallic: 1.0, roughness: 0.3, anisotropic: 0.6, ..base() }
}

fn mixed() -> Principled<f32> {
    Principled {
        metallic: 0.7,
        eta: eta(0.6),
        roughness: 0.4,
        spec_tint: 0.4,
        anisotropic: 0.5,
        sheen: 0.3,
        sheen_tint: 0.2,
        clearcoat: 0.6,
        clearcoat_gloss: 0.3,
        spec_trans: 0.4,
        flatness: 0.5,
        ..base()
    }
}

fn glass() -> Principled<f32> {
    Principled { spec_trans: 1.0, ..base() }
}

fn cloth() -> Principled<f32> {
    Principled { roughness: 0.9, sheen: 1.0, sheen_tint: 0.5, flatness: 0.7, eta: eta(0.2), ..base() }
}

fn coated() -> Principled<f32> {
    Principled { roughness: 0.6, clearcoat: 1.0, clearcoat_gloss: 0.2, spec_tint: 1.0, ..base() }
}

fn all() -> [Principled<f32>; 6] {
    [base(), metal(), mixed(), glass(), cloth(), coated()]
}

fn lanes<R: Real>(p: &Principled<f32>) -> Bsdf<'static, R> {
    Bsdf::Principled(Principled {
        base_color: Vector3::splat(p.base_color.into()),
        roughness: R::splat(p.roughness),
        anisotropic: R::splat(p.anisotropic),
        metallic: R::splat(p.metallic),
        spec_trans: R::splat(p.spec_trans),
        eta: R::splat(p.eta),
        spec_tint: R::splat(p.spec_tint),
        sheen: R::splat(p.sheen),
        sheen_tint: R::splat(p.sheen_tint),
        flatness: R::splat(p.flatness),
        clearcoat: R::splat(p.clearcoat),
        clearcoat_gloss: R::splat(p.clearcoat_gloss),
    })
}

#[test]
fn lanes_equal_scalar() {
    for parameters in all() {
        proof::lanes_equal_scalar(&lanes(&parameters), &lanes(&parameters));
    }
}

#[test]
fn opaque_ones_are_reciprocal_and_black_from_behind() {
    for parameters in [base(), metal(), cloth(), coated()] {
        proof::is_reciprocal_to(1e-4, &lanes(&parameters));
        proof::is_black_from_behind(&lanes(&parameters));
    }
}

/// Retroreflection and sheen are added to the rest, not taken from it, and the coat's quotient is missing:
/// the model does not promise to conserve energy. Metal does.
#[test]
fn metal_conserves_energy() {
    proof::conserves_energy(&lanes(&metal()));
}

#[test]
fn samples_are_distributed_by_the_density() {
    for parameters in [base(), mixed(), cloth()] {
        proof::samples_are_right(&lanes(&parameters), &[0.0, 60.0]);
    }
    proof::samples_are_right(&lanes(&Principled { clearcoat_gloss: 0.0, ..coated() }), &[30.0]);
    proof::samples_are_right(&lanes(&glass()), &[0.0, 60.0, 150.0]);
}

#[test]
fn it_is_isotropic_unless_told_otherwise() {
    assert!(proof::anisotropy(&lanes(&base())) < 1e-2);
    assert!(proof::anisotropy(&lanes(&metal())) > 0.5);
}

/// What Mitsuba 3.9.1 gives for the same parameters.
#[test]
fn it_is_that_of_mitsuba() {
    for (parameters, values) in all().iter().zip([&DEFAULT, &METAL, &MIXED, &GLASS, &CLOTH, &COAT]) {
        proof::has_values(&lanes(parameters), &proof::ABOVE, values, 5e-4);
    }
    proof::has_values(&lanes(&mixed()), &proof::THROUGH, &MIXED_THROUGH, 5e-4);
    proof::has_values(&lanes(&glass()), &proof::THROUGH, &GLASS_THROUGH, 5e-4);
}

const DEFAULT: [[f32; 4]; 6] = [
    [0.2633969, 0.1437515, 0.05401742, 0.4513881],
    [0.2616102, 0.1573072, 0.07908003, 0.7640854],
    [0.2679673, 0.182828, 0.1189736, 0.9989166],
    [0.3974016, 0.3393965, 0.2958927, 1.118652],
    [0.2210017, 0.1234502, 0.05028662, 0.4147256],
    [1.082776, 1.071553, 1.063135, 1.933259],
];
const METAL: [[f32; 4]; 6] = [
    [0.2777467, 0.1388734, 0.03471834, 0.3473199],
    [3.305138, 1.652756, 0.413469, 4.140015],
    [6.994105, 3.517816, 0.9105992, 8.744767],
    [0.6741806, 0.3734333, 0.1478729, 0.8347426],
    [0.06631318, 0.03317612, 0.008323324, 0.08308745],
    [4.346557, 3.216438, 2.368848, 5.418147],
];
const MIXED: [[f32; 4]; 6] = [
    [0.4047179, 0.2098474, 0.06369455, 0.5030958],
    [1.516684, 0.7845083, 0.2353763, 1.91943],
    [2.385248, 1.240243, 0.3814898, 3.031795],
    [1.056321, 0.6180758, 0.2893922, 1.292921],
    [0.1818875, 0.0949213, 0.02969668, 0.2424235],
    [3.5958, 2.815368, 2.230044, 4.815129],
];
const MIXED_THROUGH: [[f32; 4]; 6] = [
    [1.353537, 0.9570955, 0.4785477, 2.776683],
    [1.466925, 1.037273, 0.5186363, 3.010776],
    [0.003914271, 0.002767808, 0.001383904, 0.01498547],
    [0.354111, 0.354111, 0.354111, 2.967858],
    [4.784352, 3.383048, 1.691524, 18.39441],
    [2.542794, 1.798027, 0.8990133, 5.20979],
];
const GLASS: [[f32; 4]; 6] = [
    [0.02410606, 0.02410606, 0.02410606, 0.02415584],
    [0.05300429, 0.05300429, 0.05300429, 0.05340725],
    [0.09768874, 0.09768874, 0.09768874, 0.09953646],
    [0.2813915, 0.2813915, 0.2813915, 0.2940154],
    [0.02589875, 0.02589875, 0.02589875, 0.02618059],
    [1.060329, 1.060329, 1.060329, 1.61205],
];
const GLASS_THROUGH: [[f32; 4]; 6] = [
    [11.33718, 8.016594, 4.008297, 28.57844],
    [5.938517, 4.199166, 2.099583, 15.05237],
    [0.0689555, 0.0487589, 0.02437945, 0.03433505],
    [1.740028, 1.740028, 1.740028, 1.777821],
    [14.89422, 10.53181, 5.265903, 7.457267],
    [12.26898, 8.675478, 4.337739, 30.86724],
];
const CLOTH: [[f32; 4]; 6] = [
    [0.1815745, 0.0917085, 0.02430903, 0.2083286],
    [0.1731299, 0.08764876, 0.0235379, 0.1965943],
    [0.172546, 0.0888386, 0.02605804, 0.1852166],
    [0.2383498, 0.1377768, 0.06234703, 0.1884071],
    [0.1727979, 0.08766042, 0.02380731, 0.1903236],
    [0.156939, 0.106217, 0.06817548, 0.1430972],
];
const COAT: [[f32; 4]; 6] = [
    [0.2846363, 0.1503926, 0.04970988, 0.3694971],
    [0.2980955, 0.1714534, 0.07647175, 0.5890541],
    [0.2814133, 0.1670412, 0.08126213, 0.7731335],
    [0.3154031, 0.2204392, 0.1492164, 0.7635649],
    [0.2358343, 0.122665, 0.03778801, 0.3561783],
    [0.5044611, 0.4736499, 0.4505415, 1.428572],
];
