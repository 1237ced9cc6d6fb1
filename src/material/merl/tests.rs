use super::*;
use crate::material::{Bsdf, Distribution, Lambert, Microfacet, RoughConductor, proof};

fn gold() -> Bsdf<'static, f32> {
    Bsdf::RoughConductor(RoughConductor {
        surface: Microfacet::new(Distribution::Ggx, 0.3, 0.3),
        eta: Vec3::new(0.143, 0.375, 1.442).into(),
        k: Vec3::new(3.983, 2.386, 1.603).into(),
        reflectance: Vec3::ONE.into(),
    })
}

fn tabulated(bsdf: &Bsdf<f32>) -> MerlTable {
    MerlTable::tabulate(|wo, wi| Vec3::from(bsdf.eval(wo.into(), wi.into())) / wi.z)
}

#[test]
fn a_model_comes_back_from_its_table() {
    let (bsdf, table) = (gold(), tabulated(&gold()));
    let measured = Measured { table: &table };
    let mut random = proof::Random::new(1);
    for _ in 0..50_000 {
        let (wo, wi) = (random.direction(false), random.direction(false));
        // At the horizon, cells are half empty.
        if wo.z < 0.2 || wi.z < 0.2 {
            continue;
        }
        let (want, got) = (bsdf.eval(wo.into(), wi.into()), measured.eval::<f32>(wo.into(), wi.into()));
        let (want, got) = (Vec3::from(want), Vec3::from(got));
        assert!(
            (want - got).abs().max_element() < 0.02 * want.max_element() + 1e-3,
            "{wo} {wi}: {want} {got}"
        );
    }
}

/// What turns with cos 2φ_d: where the half vector is the normal, φ_d is the azimuth.
#[test]
fn values_stand_at_their_azimuths() {
    let about = |phi: f32| 1.0 + 0.5 * (2.0 * phi).cos();
    let table = MerlTable::tabulate(|wo, wi| {
        let (_, _, phi) = angles::<f32>((wo + wi).normalize().into(), wi.into());
        Vec3::splat(about(phi))
    });
    let measured = Measured { table: &table };
    for step in 0..1440 {
        let (phi, (sin, cos)) = ((step as f32 * 0.25).to_radians(), 40f32.to_radians().sin_cos());
        let wi = Vec3::new(sin * phi.cos(), sin * phi.sin(), cos);
        let wo = Vec3::new(-wi.x, -wi.y, wi.z);
        let got = measured.eval::<f32>(wo.into(), wi.into()).x / wi.z;
        assert!((got - about(phi)).abs() < 3e-3, "{}°: {got}, not {}", phi.to_degrees(), about(phi));
    }
}

#[test]
fn a_constant_is_a_constant_everywhere() {
    let white = Bsdf::Lambert(Lambert { reflectance: Vec3::ONE.into() });
    let table = tabulated(&white);
    let measured = Measured { table: &table };
    for (wo, wi) in [(0.0, 0.0), (10.0, 50.0), (60.0, 60.0)] {
        let (wo, wi) = (proof::at(wo), proof::at(wi));
        let got = measured.eval::<f32>(wo.into(), wi.into()).x;
        assert!((got - wi.z / PI).abs() < 1e-5, "{wo} {wi}: {got}");
    }
}

#[test]
fn it_is_sound() {
    let table = tabulated(&gold());
    let bsdf = Bsdf::Measured(Measured { table: &table });
    proof::is_reciprocal_to(1e-3, &bsdf);
    proof::is_black_from_behind(&bsdf);
    proof::conserves_energy(&bsdf);
    proof::samples_are_right(&bsdf, &[0.0, 40.0, 75.0]);
    assert!(proof::anisotropy(&bsdf) < 2e-2);
}

#[test]
fn lanes_equal_scalar() {
    let table = tabulated(&gold());
    let measured = Measured { table: &table };
    proof::lanes_equal_scalar(&Bsdf::Measured(measured), &Bsdf::Measured(measured));
}

#[test]
fn bytes_survive_the_round_trip() {
    let table = tabulated(&gold());
    let bytes = table.encode();
    assert_eq!(bytes.len(), 12 + 90 * 90 * 180 * 24);
    let back = MerlTable::decode(&bytes).expect("it was just written");
    let close = |a: &[f32; 3], b: &[f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-6 * a);
    assert!(table.values.iter().zip(&back.values).all(|(a, b)| close(a, b)));
}

#[test]
fn what_is_no_table_is_refused() {
    let mut bytes = tabulated(&gold()).encode();
    let refusal = |bytes: &[u8]| MerlTable::decode(bytes).expect_err("it is damaged").to_string();
    assert!(refusal(&bytes[..5]).contains("5 bytes"));
    assert!(refusal(&bytes[..1000]).contains("1000 bytes"));
    bytes[12 + 8 * 7..][..8].copy_from_slice(&f64::NAN.to_le_bytes());
    assert_eq!(refusal(&bytes), "value 7 of red is not a finite number");
    bytes[12 + 8 * 7..][..8].copy_from_slice(&(-1.0f64).to_le_bytes());
    let table = MerlTable::decode(&bytes).expect("negative is not measured");
    assert_eq!(table.values[7][0], 0.0);
    bytes[0] = 91;
    assert!(refusal(&bytes).contains("91 × 90 × 180"));
}
