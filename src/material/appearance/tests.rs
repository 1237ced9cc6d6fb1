use glam::Vec3;

use super::*;
use crate::material::{Factor, MaterialId, MaterialRow, MaterialTable, Model, Tables, proof};
use crate::simd::f32x8;
use crate::texture::{Texture, TextureId};

/// Constants, and a material of these layers that name them.
fn table(constants: &[Vec3], layers: Vec<Layer>) -> (TextureTable, MaterialTable) {
    let mut textures = TextureTable::default();
    for (i, color) in constants.iter().enumerate() {
        assert_eq!(textures.add(Texture::Constant(*color)), TextureId(i as u32), "constants differ");
    }
    let mut others = layers;
    let first = others.remove(0);
    (textures, MaterialTable::new(vec![MaterialRow { first, others }], Tables::default()).0)
}

fn layer(model: Model, factors: &[Factor], steps: &[Step]) -> Layer {
    Layer { model, factors: factors.to_vec(), steps: steps.to_vec() }
}

fn lambert(texture: u32) -> Model {
    Model::Lambert { reflectance: TextureId(texture) }
}

fn factor(texture: u32, complement: bool) -> Factor {
    Factor { texture: TextureId(texture), complement }
}

fn look<'t, R: Real>((textures, table): &'t (TextureTable, MaterialTable), wo: Vec3) -> Appearance<'t, R> {
    let point = Point {
        wo: Vector3::splat(wo),
        uv: (R::zero(), R::zero()).into(),
        tangents: [Vector3::splat(Vec3::X), Vector3::splat(Vec3::Y)],
    };
    table.appearance(MaterialId(0), textures, &point)
}

fn eval(scene: &(TextureTable, MaterialTable), wo: Vec3, wi: Vec3) -> Vec3 {
    look::<f32>(scene, wo).eval(wi.into()).0.into()
}

const PLAIN: Relief = Relief { flips: false, shadows: false };
const INV_PI: f32 = std::f32::consts::FRAC_1_PI;

#[test]
fn a_blend_is_the_weighted_sum_of_both_and_of_their_densities() {
    let scene = table(
        &[Vec3::new(1.0, 0.0, 0.5), Vec3::new(0.0, 0.5, 0.25), Vec3::splat(0.3)],
        vec![layer(lambert(0), &[factor(2, true)], &[]), layer(lambert(1), &[factor(2, false)], &[])],
    );
    let (wo, wi) = (proof::at(20.0), proof::at(50.0));
    let want = Vec3::new(0.7, 0.15, 0.425) * INV_PI * wi.z;
    assert!((eval(&scene, wo, wi) - want).length() < 1e-6);
    let look = look::<f32>(&scene, wo);
    let mut random = proof::Random::new(1);
    for _ in 0..1000 {
        let sample = look.sample(random.unit(), (random.unit(), random.unit()));
        assert!(sample.valid && (sample.pdf - sample.wi.z * INV_PI).abs() < 1e-6);
        assert!((Vec3::from(sample.weight) - Vec3::new(0.7, 0.15, 0.425)).length() < 1e-5);
    }
}

#[test]
fn a_mask_lets_light_pass_where_it_is_open() {
    let scene = table(
        &[Vec3::new(0.8, 0.6, 0.4), Vec3::splat(0.25)],
        vec![layer(lambert(0), &[factor(1, false)], &[]), layer(Model::Transparent, &[factor(1, true)], &[])],
    );
    let (wo, wi) = (proof::at(20.0), proof::at(50.0));
    assert!((eval(&scene, wo, wi).x - 0.2 * INV_PI * wi.z).abs() < 1e-6);
    let look = look::<f32>(&scene, wo);
    let [none, through] = look.branches();
    assert!(!none.valid && through.valid);
    assert_eq!((Vec3::from(through.wi), Vec3::from(through.weight)), (-wo, Vec3::splat(0.75)));
    let (mut random, mut passed) = (proof::Random::new(2), 0);
    for _ in 0..100_000 {
        let sample = look.sample(random.unit(), (random.unit(), random.unit()));
        if sample.delta {
            passed += 1;
            assert_eq!((Vec3::from(sample.wi), Vec3::from(sample.weight)), (-wo, Vec3::ONE));
        } else {
            assert!((Vec3::from(sample.weight) - Vec3::new(0.8, 0.6, 0.4)).length() < 1e-5);
        }
    }
    assert!((f64::from(passed) / 1e5 - 0.75).abs() < 6e-3, "{passed}");
}

#[test]
fn two_sides_are_seen_each_from_its_own() {
    let one = table(&[Vec3::ONE], vec![layer(lambert(0), &[], &[Step::Turn])]);
    let two = table(
        &[Vec3::X, Vec3::Y],
        vec![layer(lambert(0), &[], &[Step::Front]), layer(lambert(1), &[], &[Step::Back])],
    );
    let (wo, wi) = (proof::at(20.0), proof::at(50.0));
    let full = wi.z * INV_PI;
    for (scene, front, back) in [(&one, Vec3::ONE, Vec3::ONE), (&two, Vec3::X, Vec3::Y)] {
        assert!((eval(scene, wo, wi) - front * full).length() < 1e-6);
        assert!((eval(scene, -wo, -wi) - back * full).length() < 1e-6);
        assert_eq!(eval(scene, wo, -wi), Vec3::ZERO);
        let sample = look::<f32>(scene, -wo).sample(0.99, (0.3, 0.4));
        assert!(sample.valid && sample.wi.z < 0.0);
        assert!((Vec3::from(sample.weight) - back).length() < 1e-5);
    }
}

#[test]
fn a_leaning_normal_leans_the_lobe() {
    // A colour whose normal leans 30 degrees to +x.
    let n = Vec3::new(0.5, 0.0, 0.866_025_4);
    for steps in [
        vec![Step::Normal { texture: TextureId(1), relief: PLAIN }],
        vec![Step::Turn, Step::Normal { texture: TextureId(1), relief: PLAIN }],
    ] {
        let scene = table(&[Vec3::ONE, n * 0.5 + 0.5], vec![layer(lambert(0), &[], &steps)]);
        for wi in [proof::at(10.0), proof::at(60.0), Vec3::new(0.9, 0.0, 0.43).normalize()] {
            let got = eval(&scene, Vec3::Z, wi).x;
            assert!((got - n.dot(wi).max(0.0) * INV_PI).abs() < 1e-6, "{wi}: {got}");
        }
        // On the model's side and not on the surface's.
        assert_eq!(eval(&scene, Vec3::Z, Vec3::new(0.99, 0.0, -0.1).normalize()), Vec3::ZERO);
    }
}

/// What Mitsuba 3.9.1 gives for π f cos θ of a white surface, by its own defaults.
#[test]
fn grazing_light_is_shadowed_and_hidden_normals_lean_the_other_way() {
    let up = |degrees: f32| {
        let (s, c) = degrees.to_radians().sin_cos();
        Vec3::new(s, 0.0, c)
    };
    for (tilt, wo, wi, want) in [
        (30.0, 0.0, 0.0, 0.8660),
        (30.0, 0.0, 60.0, 0.8405),
        (30.0, 0.0, 80.0, 0.5082),
        (30.0, -70.0, 30.0, 0.4983),
        (30.0, -70.0, -50.0, 0.9262),
        (60.0, 0.0, 60.0, 0.8138),
        (60.0, -40.0, -30.0, 0.8405),
        (60.0, -40.0, 60.0, 0.0),
    ] {
        let step = Step::Normal { texture: TextureId(1), relief: Relief::default() };
        let scene = table(&[Vec3::ONE, up(tilt) * 0.5 + 0.5], vec![layer(lambert(0), &[], &[step])]);
        let got = eval(&scene, up(wo), up(wi)).x / INV_PI;
        assert!((got - want).abs() < 1e-4, "{tilt} {wo} {wi}: {got}, not {want}");
    }
}

#[test]
fn samples_of_layers_match_their_density_in_every_view() {
    let gold = Model::Phong { diffuse: TextureId(0), specular: TextureId(1), exponent: TextureId(4) };
    let n = Vec3::new(0.3, -0.2, 0.93).normalize();
    let constants = [Vec3::splat(0.3), Vec3::splat(0.6), Vec3::splat(0.4), n * 0.5 + 0.5, Vec3::splat(8.0)];
    let lean = Step::Normal { texture: TextureId(3), relief: Relief::default() };
    for steps in [&[][..], &[Step::Turn], &[lean], &[lean, Step::Turn], &[Step::Turn, lean]] {
        let scene = table(
            &constants,
            vec![
                layer(lambert(0), &[factor(2, true)], &[Step::Turn]),
                layer(gold, &[factor(2, false)], steps),
            ],
        );
        let wo = proof::at(40.0);
        let look = look::<f32>(&scene, wo);
        let total = proof::hemisphere(|wi| f64::from(look.eval(wi).1));
        let (mut random, count) = (proof::Random::new(3), 200_000);
        let (mut valid, mut light, mut up) = (0.0, 0.0, 0.0);
        for _ in 0..count {
            let sample = look.sample(random.unit(), (random.unit(), random.unit()));
            if sample.valid {
                valid += 1.0;
                light += f64::from(sample.weight.x);
                up += f64::from(sample.wi.x);
                let (f, pdf) = look.eval(sample.wi);
                assert!((pdf - sample.pdf).abs() < 1e-4 * pdf && (f.x / pdf - sample.weight.x).abs() < 1e-4);
            }
        }
        let n = f64::from(count);
        assert!((valid / n - total).abs() < 5e-3, "{steps:?}: {total} {}", valid / n);
        let albedo = proof::hemisphere(|wi| f64::from(look.eval(wi).0.x));
        assert!((light / n - albedo).abs() < 5e-3, "{steps:?}: {albedo} {}", light / n);
        let mean = proof::hemisphere(|wi| f64::from(look.eval(wi).1 * wi.x));
        assert!((up / n - mean).abs() < 5e-3, "{steps:?}: {mean} {}", up / n);
    }
}

#[test]
fn lanes_equal_scalar() {
    let mirror = Model::Conductor { eta: TextureId(0), k: TextureId(1), reflectance: TextureId(1) };
    let n = Vec3::new(0.3, -0.2, 0.93).normalize();
    let scene = table(
        &[Vec3::ZERO, Vec3::ONE, Vec3::splat(0.4), n * 0.5 + 0.5, Vec3::splat(0.7)],
        vec![
            layer(
                lambert(1),
                &[factor(2, true)],
                &[Step::Turn, Step::Normal { texture: TextureId(3), relief: Relief::default() }],
            ),
            layer(mirror, &[factor(2, false), factor(4, false)], &[Step::Turn]),
            layer(Model::Transparent, &[factor(2, false), factor(4, true)], &[]),
        ],
    );
    let mut random = proof::Random::new(4);
    for _ in 0..2000 {
        let (wo, wi) = (random.direction(true), random.direction(true));
        let (lobe, u) = (random.unit(), (random.unit(), random.unit()));
        let (one, eight) = (look::<f32>(&scene, wo), look::<f32x8>(&scene, wo));
        let bits = |v: Vec3| v.to_array().map(f32::to_bits);
        let ((f, pdf), (f8, pdf8)) = (one.eval(wi.into()), eight.eval(Vector3::splat(wi)));
        assert_eq!((bits(f.into()), pdf.to_bits()), (bits(f8.lane(6)), pdf8.lane(6).to_bits()));
        let splat = f32x8::splat;
        let (a, b) = (one.sample(lobe, u), eight.sample(splat(lobe), (splat(u.0), splat(u.1))));
        assert_eq!((a.valid, a.delta), (b.valid.lane(2), b.delta.lane(2)));
        if a.valid {
            assert_eq!(
                (bits(a.wi.into()), bits(a.weight.into())),
                (bits(b.wi.lane(2)), bits(b.weight.lane(2)))
            );
        }
    }
}

/// The other way round, the normal points the other way and the tangents stay; what was hidden stays hidden.
#[test]
fn a_leaning_view_turns_about_its_tangents() {
    let mut random = proof::Random::new(13);
    for _ in 0..200 {
        let frame = Frame::<f32>::around(random.direction(false).into());
        let view = View::Leaning { frame, parity: 1.0, spread: 0.1 };
        let (w, turned) = (Vector3::from(random.direction(true)), view.turned(-1.0));
        let (before, after) = (view.to_model(w), turned.to_model(w));
        assert_eq!((after.x, after.y, after.z), (before.x, before.y, -before.z));
        assert!((Vec3::from(turned.to_surface(after)) - Vec3::from(w)).length() < 1e-5);
        assert_eq!(turned.agrees(w, after), view.agrees(w, before));
    }
}
