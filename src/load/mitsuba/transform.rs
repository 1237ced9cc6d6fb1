//! Transforms: the steps in the order written, composed in double precision.

use glam::{DAffine2, DAffine3, DMat2, DMat3, DVec2, DVec3};

use super::{attributes::Attributes, source::Span, vocabulary::did_you_mean};
use crate::load::LoadError;

const STEPS: [&str; 5] = ["translate", "scale", "rotate", "lookat", "matrix"];

/// The product of the steps: the first one written is applied first.
pub(super) fn compose(steps: Vec<Attributes>) -> Result<DAffine3, LoadError> {
    steps.into_iter().try_fold(DAffine3::IDENTITY, |product, step| {
        let tag = step.tag.clone();
        let product = read_step(step)? * product;
        match product.as_affine3().is_finite() {
            true => Ok(product),
            false => Err(tag.error("the transform overflows here")),
        }
    })
}

fn read_step(mut step: Attributes) -> Result<DAffine3, LoadError> {
    let matrix = match step.element.as_str() {
        "translate" => DAffine3::from_translation(step.triple(0.0)?.unwrap_or_default().into()),
        "scale" => DAffine3::from_scale(read_scale(&mut step)?),
        "rotate" => read_rotation(&mut step)?,
        "lookat" => read_look_at(&mut step)?,
        "matrix" => read_matrix(&mut step)?,
        other => {
            return Err(step.tag.error(format!("a transform has no step `{other}`")).help(did_you_mean(
                other,
                STEPS,
                "the steps of a transform",
            )));
        }
    };
    step.finish()?;
    Ok(matrix)
}

fn read_scale(step: &mut Attributes) -> Result<DVec3, LoadError> {
    if let Some(value) = step.take("value") {
        if let [number] = value.numbers()?[..] {
            return Ok(DVec3::splat(number));
        }
        return Ok(value.array::<3>()?.into());
    }
    Ok(step.triple(1.0)?.map_or(DVec3::ONE, DVec3::from))
}

fn read_rotation(step: &mut Attributes) -> Result<DAffine3, LoadError> {
    let angle = step.require("angle")?.number()?;
    let axis = DVec3::from(step.triple(0.0)?.unwrap_or_default());
    let axis = axis.try_normalize().ok_or_else(|| {
        step.tag.error("the axis of a rotation is zero").help("write an axis: <rotate y=\"1\" angle=\"30\"/>")
    })?;
    Ok(rotation(axis, angle))
}

/// Counter-clockwise about a unit axis, in degrees; quarter turns are exact.
fn rotation(axis: DVec3, degrees: f64) -> DAffine3 {
    let turn = degrees % 360.0;
    let (sin, cos) = match turn / 90.0 {
        0.0 => (0.0, 1.0),
        1.0 | -3.0 => (1.0, 0.0),
        2.0 | -2.0 => (0.0, -1.0),
        3.0 | -1.0 => (-1.0, 0.0),
        _ => libm::sincos(turn.to_radians()),
    };
    let column = |e: DVec3| e * cos + axis.cross(e) * sin + axis * (axis.dot(e) * (1.0 - cos));
    DAffine3::from_mat3(DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z)))
}

fn read_look_at(step: &mut Attributes) -> Result<DAffine3, LoadError> {
    let origin = DVec3::from(step.require("origin")?.array::<3>()?);
    let target = DVec3::from(step.require("target")?.array::<3>()?);
    let up = step.require("up")?;
    let direction = (target - origin)
        .try_normalize()
        .ok_or_else(|| step.tag.error("`origin` and `target` are the same point"))?;
    // Compared as unit vectors, so that only the angle between them counts.
    let left = DVec3::from(up.array::<3>()?).normalize_or_zero().cross(direction);
    if left.length() < 1e-9 {
        return Err(up
            .error("`up` is zero or parallel to the direction of view")
            .help("choose an `up` that points to the side of the line from `origin` to `target`"));
    }
    let left = left.normalize();
    let basis = DMat3::from_cols(left, direction.cross(left), direction);
    Ok(DAffine3::from_mat3_translation(basis, origin))
}

fn read_matrix(step: &mut Attributes) -> Result<DAffine3, LoadError> {
    let value = step.require("value")?;
    let m = value.array::<16>()?;
    if m[12..] != [0.0, 0.0, 0.0, 1.0] {
        return Err(value
            .error("the last row of the matrix is not `0 0 0 1`")
            .help("matrices are written row by row, the translation is in the fourth column"));
    }
    let column = |i: usize| DVec3::new(m[i], m[i + 4], m[i + 8]);
    let basis = DMat3::from_cols(column(0), column(1), column(2));
    Ok(DAffine3::from_mat3_translation(basis, column(3)))
}

/// What a transform does to the xy plane.
pub(super) fn planar(m: DAffine3) -> DAffine2 {
    let xy = |v: DVec3| DVec2::new(v.x, v.y);
    let basis = DMat2::from_cols(xy(m.matrix3.x_axis), xy(m.matrix3.y_axis));
    DAffine2::from_mat2_translation(basis, xy(m.translation))
}

/// Passes a transform that can be undone.
pub(super) fn invertible(m: DAffine3, span: &Span) -> Result<DAffine3, LoadError> {
    let columns = [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis];
    let volume: f64 = columns.iter().map(|c| c.length()).product();
    // Relative to the columns: a flattened box stays flat when it is rotated, up to rounding.
    let flat = m.matrix3.determinant().abs() <= 1e-14 * volume;
    match flat || !m.inverse().as_affine3().is_finite() {
        true => Err(span
            .error("the transform is singular: it flattens space")
            .label("no inverse")
            .help("no factor of a scale may be 0")),
        false => Ok(m),
    }
}

/// The factor by which a similarity scales; `None` if the transform shears or scales unevenly.
pub(super) fn similarity(m: DAffine3) -> Option<f64> {
    // Matrices are often written out from single precision.
    const TOLERANCE: f64 = 1e-5;
    let [x, y, z] = [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis];
    let factor = x.length();
    let even = |c: DVec3| (c.length() - factor).abs() <= TOLERANCE * factor;
    let square = |a: DVec3, b: DVec3| a.dot(b).abs() <= TOLERANCE * factor * factor;
    (even(y) && even(z) && square(x, y) && square(y, z) && square(z, x)).then_some(factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_turn_counter_clockwise_and_quarter_turns_are_exact() {
        assert_eq!(rotation(DVec3::X, -90.0).transform_vector3(DVec3::Z), DVec3::Y);
        assert_eq!(rotation(DVec3::Z, 450.0).transform_vector3(DVec3::X), DVec3::Y);
        let turned = rotation(DVec3::Y, 30.0).transform_vector3(DVec3::Z);
        assert!((turned - DVec3::new(0.5, 0.0, 0.75_f64.sqrt())).length() < 1e-15);
    }

    #[test]
    fn rotations_about_a_slanted_axis_keep_it_and_are_rigid() {
        let axis = DVec3::new(1.0, 2.0, -3.0).normalize();
        let m = rotation(axis, 77.0);
        assert!((m.transform_vector3(axis) - axis).length() < 1e-15);
        assert!((m.matrix3.determinant() - 1.0).abs() < 1e-15);
        assert_eq!(similarity(m).map(|s| (s * 1e6).round()), Some(1e6));
    }

    #[test]
    fn uneven_scales_and_shears_are_no_similarities() {
        assert_eq!(similarity(DAffine3::from_scale(DVec3::new(1.0, 1.0, 1.1))), None);
        let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.1, 1.0, 0.0).normalize(), DVec3::Z);
        assert_eq!(similarity(DAffine3::from_mat3(shear)), None);
        assert_eq!(similarity(DAffine3::from_scale(DVec3::splat(-2.0))), Some(2.0));
    }

    #[test]
    fn the_plane_keeps_its_scale_and_translation() {
        let m = DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0))
            * DAffine3::from_scale(DVec3::new(4.0, 5.0, 6.0));
        assert_eq!(planar(m).transform_point2(DVec2::ONE), DVec2::new(5.0, 7.0));
    }
}
