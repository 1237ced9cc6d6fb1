use super::*;
use crate::simd::{Real, f32x8};

/// A repeatable sequence in [0, 1).
fn random(i: u32) -> f32 {
    let x = i.wrapping_mul(0x9e37_79b9) ^ 0x85eb_ca6b;
    let x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    ((x ^ (x >> 16)) >> 8) as f32 / 16_777_216.0
}

/// Texels from dark to a thousand times as bright, a third of them black.
fn speckled(width: u32, height: u32) -> Envmap {
    let texel = |i: u32| match random(i) {
        dark if dark < 0.33 => [0.0; 3],
        light => [0, 1, 2].map(|band| random(3 * i + band + 7) * 1e3f32.powf(light)),
    };
    let turn = glam::Mat3::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.7);
    Envmap::new((0..width * height).map(texel).collect(), width, [turn.x_axis, turn.y_axis, turn.z_axis])
}

fn upright(texels: Vec<[f32; 3]>, width: u32) -> Envmap {
    Envmap::new(texels, width, [Vec3::X, Vec3::Y, Vec3::Z])
}

/// A row of grey texels of value 1, 2, …
fn numbered(width: u32, height: u32) -> Envmap {
    upright((0..width * height).map(|i| [i as f32 + 1.0; 3]).collect(), width)
}

fn toward(theta: f64, phi: f64) -> Vector3<f32> {
    let (sin, cos) = theta.sin_cos();
    Vec3::new((sin * phi.sin()) as f32, cos as f32, (-sin * phi.cos()) as f32).into()
}

#[test]
fn texels_are_where_they_belong() {
    let map = numbered(4, 3);
    let at = |x: f32, y: f32, z: f32| map.arriving::<f32>(Vec3::new(x, y, z).normalize().into()).0.x;
    // On the equator: −z between the last and the first column, +x between the first and the second.
    assert!((at(0.0, 0.0, -1.0) - 6.5).abs() < 1e-5);
    assert!((at(1.0, 0.0, 0.0) - 5.5).abs() < 1e-5);
    assert!((at(0.0, 0.0, 1.0) - 6.5).abs() < 1e-5);
    assert!((at(1.0, 0.0, -1.0) - 5.0).abs() < 1e-5);
    // Poles have no azimuth of their own: the texels' is that of +z, the side from which it is reached.
    assert!((1.0..=4.0).contains(&at(0.0, 1.0, 0.0)) && (9.0..=12.0).contains(&at(0.0, -1.0, 0.0)));
    // Half way between the equator and the pole, rows count half.
    assert!((at(1.0, 2.0f32.sqrt(), -1.0) - 3.0).abs() < 1e-5);
}

#[test]
fn a_map_of_ones_is_the_whole_sphere() {
    for (width, height) in [(1, 1), (1, 2), (2, 1), (3, 3), (64, 33), (64, 32)] {
        let map = upright(vec![[1.0; 3]; width * height], width as u32);
        assert!((f64::from(map.flux().x) - 4.0 * std::f64::consts::PI).abs() < 1e-5);
        for i in 0..1000 {
            let dir = map.sample((random(i), random(i + 5000)));
            let (radiance, pdf) = map.arriving(dir);
            assert!((radiance.x - 1.0).abs() < 1e-6 && (pdf * 4.0 * PI - 1.0).abs() < 1e-5, "{pdf}");
            assert!((dir.length() - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn the_density_integrates_to_one() {
    for (width, height) in [(16, 9), (16, 8), (5, 2)] {
        let map = speckled(width, height);
        let (rows, columns) = (1800, 3600);
        let mut total = 0.0;
        for j in 0..rows {
            let theta = (f64::from(j) + 0.5) / f64::from(rows) * std::f64::consts::PI;
            for i in 0..columns {
                let phi = (f64::from(i) + 0.5) / f64::from(columns) * std::f64::consts::TAU;
                total += f64::from(map.arriving(toward(theta, phi)).1) * theta.sin();
            }
        }
        total *= 2.0 * std::f64::consts::PI.powi(2) / f64::from(rows * columns);
        assert!((total - 1.0).abs() < 1e-4, "{width} x {height}: {total}");
    }
}

/// Samples fall into 24 × 48 bins of cos θ and φ as the density says: Pearson's χ², by the normal
/// approximation of its cube root, p > 0.01.
#[test]
fn sampling_matches_the_density() {
    const ROWS: usize = 24;
    const COLUMNS: usize = 48;
    for (width, height) in [(16, 9), (16, 8), (7, 2), (96, 64)] {
        let map = speckled(width, height);
        let count = 1 << 19;
        let mut seen = vec![0u32; ROWS * COLUMNS];
        for i in 0..count {
            let dir = map.sample((random(2 * i + 1), random(0x4000_0000 + i)));
            let z = (f64::from(dir.z) + 1.0) / 2.0 * ROWS as f64;
            let turn = f64::from(dir.y).atan2(f64::from(dir.x)) / std::f64::consts::TAU;
            let phi = turn.rem_euclid(1.0) * COLUMNS as f64;
            seen[(z as usize).min(ROWS - 1) * COLUMNS + (phi as usize).min(COLUMNS - 1)] += 1;
        }
        let (mut chi2, mut freedom, mut rest) = (0.0, -1.0f64, (0.0, 0.0));
        let fine = 48;
        for (bin, &seen) in seen.iter().enumerate() {
            let mut share = 0.0;
            for k in 0..fine * fine {
                let inside = |k: usize| (k as f64 + 0.5) / fine as f64;
                let z = ((bin / COLUMNS) as f64 + inside(k / fine)) / ROWS as f64 * 2.0 - 1.0;
                let phi =
                    ((bin % COLUMNS) as f64 + inside(k % fine)) / COLUMNS as f64 * std::f64::consts::TAU;
                let r = (1.0 - z * z).sqrt();
                let dir = Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32);
                share += f64::from(map.arriving::<f32>(dir.into()).1);
            }
            share *= 4.0 * std::f64::consts::PI / (ROWS * COLUMNS * fine * fine) as f64;
            let (expected, seen) = (share * f64::from(count), f64::from(seen));
            if expected < 8.0 {
                rest = (rest.0 + expected, rest.1 + seen);
            } else {
                chi2 += (seen - expected).powi(2) / expected;
                freedom += 1.0;
            }
        }
        if rest.0 >= 8.0 {
            chi2 += (rest.1 - rest.0) * (rest.1 - rest.0) / rest.0;
            freedom += 1.0;
        }
        let s = 2.0 / (9.0 * freedom);
        // 2.326 standard deviations: p = 0.01 on the one side that matters.
        let z = ((chi2 / freedom).cbrt() - (1.0 - s)) / s.sqrt();
        assert!(z < 2.326, "{width} x {height}: χ² = {chi2} of {freedom} degrees of freedom");
    }
}

#[test]
fn one_bright_texel_draws_what_it_lights() {
    let mut texels = vec![[1e-3f32; 3]; 64 * 32];
    texels[9 * 64 + 20] = [5e4; 3];
    let map = upright(texels, 64);
    let sun = toward(std::f64::consts::PI * 9.0 / 31.0, std::f64::consts::TAU * 20.5 / 64.0);
    let near = (0..1000).filter(|&i| map.sample((random(i), random(i + 9999))).dot(sun) > 0.97).count();
    assert!(near > 990, "{near}");
}

#[test]
fn a_black_map_sends_nothing() {
    let map = upright(vec![[0.0; 3]; 8], 4);
    let dir = map.sample::<f32>((0.3, 0.8));
    assert!((dir.length() - 1.0).abs() < 1e-6);
    let (radiance, pdf) = map.arriving(dir);
    assert_eq!((Vec3::from(radiance), pdf), (Vec3::ZERO, 0.0));
}

#[test]
fn lanes_have_the_scalar_bits() {
    let map = speckled(16, 9);
    for i in 0..2000u32 {
        let number = |salt: u32| f32x8::from_fn(|k| random(8 * i + k as u32 + salt));
        let (u, v) = (number(0), number(1 << 20));
        let dir = map.sample((u, v));
        let (radiance, pdf) = map.arriving(dir);
        for k in 0..8 {
            let one = map.sample((u.lane(k), v.lane(k)));
            assert_eq!(
                dir.lane(k).to_array().map(f32::to_bits),
                Vec3::from(one).to_array().map(f32::to_bits)
            );
            let (want, density) = map.arriving(one);
            assert_eq!(pdf.lane(k).to_bits(), density.to_bits());
            assert_eq!(
                radiance.lane(k).to_array().map(f32::to_bits),
                Vec3::from(want).to_array().map(f32::to_bits)
            );
        }
    }
}
