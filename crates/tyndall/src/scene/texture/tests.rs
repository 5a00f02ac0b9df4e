//! Look-ups compared with values that Mitsuba 3.9.1 gives for the same picture.

use super::*;
use crate::math::Transform;
use crate::scene::desc::{Filter, ImageDesc, Wrap};
use std::sync::Arc;

/// Three columns, two rows; red differs everywhere, green by the row, blue by the column.
fn picture(filter: Filter, wrap: Wrap, to_uv: Transform) -> Texture {
    let mut pixels = Vec::new();
    for (row, green) in [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]].into_iter().zip([0.2, 0.9]) {
        for (red, blue) in row.into_iter().zip([0.0, 0.5, 1.0]) {
            pixels.push([red, green, blue]);
        }
    }
    let image = Arc::new(ImageDesc { width: 3, height: 2, pixels });
    Texture::compile(&TextureDesc::Bitmap { image, filter, wrap, to_uv }).unwrap()
}

fn at(u: f32, v: f32) -> TexturePoint<'static> {
    TexturePoint::at_uv(Vec2::new(u, v))
}

fn assert_near(found: &[f32], expected: &[f32], what: &str) {
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < 2e-5, "{what}: {found:?}, expected {expected:?}");
    }
}

#[test]
fn nearest_pixels_lie_where_mitsuba_has_them() {
    let t = picture(Filter::Nearest, Wrap::Repeat, Transform::IDENTITY);
    for (u, v, rgb, grey) in [
        (0.1, 0.1, [0.1, 0.2, 0.0], 0.164_299_1),
        (0.5, 0.1, [0.2, 0.2, 0.5], 0.221_650_7),
        (0.9, 0.9, [0.6, 0.9, 1.0], 0.843_415_56),
        (0.1, 0.9, [0.4, 0.9, 0.0], 0.728_712_4),
    ] {
        assert_near(&t.eval(&at(u, v)).to_rgb(), &rgb, "nearest");
        assert_near(&[t.eval_grey(&at(u, v))], &[grey], "grey");
        assert_eq!(t.gradient(&at(u, v)), Vec2::ZERO);
    }
}

#[test]
fn interpolation_wrapping_and_gradients_agree_with_mitsuba() {
    type Row = (Wrap, [f32; 2], [f32; 3], [f32; 2]);
    const REPEAT: Wrap = Wrap::Repeat;
    const MIRROR: Wrap = Wrap::Mirror;
    const CLAMP: Wrap = Wrap::Clamp;
    let rows: [Row; 13] = [
        (REPEAT, [1.0 / 6.0, 0.25], [0.1, 0.2, 0.0], [0.172_055, 1.128_83]),
        (REPEAT, [0.0, 0.25], [0.2, 0.2, 0.5], [-0.344_11, 1.128_83]),
        (REPEAT, [1.05, 0.6], [0.38, 0.69, 0.35], [-0.344_11, 1.128_83]),
        (REPEAT, [-0.05, 1.3], [0.26, 0.27, 0.65], [-0.344_11, 1.128_83]),
        (REPEAT, [2.3, -1.4], [0.35, 0.69, 0.2], [0.172_055, 1.128_83]),
        (MIRROR, [0.0, 0.25], [0.1, 0.2, 0.0], [0.0, 1.128_83]),
        (MIRROR, [1.05, 0.6], [0.51, 0.69, 1.0], [0.0, 1.128_83]),
        (MIRROR, [-0.05, 1.3], [0.37, 0.83, 0.0], [0.0, -1.128_83]),
        (MIRROR, [2.3, -1.4], [0.35, 0.69, 0.2], [0.172_055, 1.128_83]),
        (CLAMP, [0.0, 0.25], [0.1, 0.2, 0.0], [0.0, 1.128_83]),
        (CLAMP, [1.05, 0.6], [0.51, 0.69, 1.0], [0.0, 1.128_83]),
        (CLAMP, [-0.05, 1.3], [0.4, 0.9, 0.0], [0.0, 0.0]),
        (CLAMP, [2.3, -1.4], [0.3, 0.2, 1.0], [0.0, 0.0]),
    ];
    for (wrap, [u, v], rgb, gradient) in rows {
        let t = picture(Filter::Linear, wrap, Transform::IDENTITY);
        assert_near(&t.eval(&at(u, v)).to_rgb(), &rgb, &format!("{wrap:?} {u} {v}"));
        assert_near(&t.gradient(&at(u, v)).to_array(), &gradient, &format!("gradient {wrap:?} {u} {v}"));
    }
}

#[test]
fn uv_transforms_agree_with_mitsuba() {
    let shrink = Transform::translate([0.1, 0.2, 0.0]).then(&Transform::scale([2.0, 3.0, 1.0]));
    let t = picture(Filter::Linear, Wrap::Repeat, shrink);
    assert_near(&t.eval(&at(0.3, 0.25)).to_rgb(), &[0.35, 0.34, 0.95], "scaled");
    assert_near(&t.gradient(&at(0.05, 0.1)).to_array(), &[0.344_11, -3.386_48], "scaled gradient");
    let turn = shrink.then(&Transform::rotate([0.0, 0.0, 1.0], 30.0).unwrap());
    let t = picture(Filter::Linear, Wrap::Repeat, turn);
    assert_near(&t.eval(&at(0.3, 0.25)).to_rgb(), &[0.380_788, 0.646_788, 0.446_539], "turned");
}

#[test]
fn gradients_are_the_slopes_of_the_grey_value() {
    let turn = Transform::scale([1.5, 0.7, 1.0]).then(&Transform::rotate([0.0, 0.0, 1.0], 70.0).unwrap());
    let t = picture(Filter::Linear, Wrap::Mirror, turn);
    let (u, v, h) = (0.31, 0.17, 1e-3);
    let slope = |a: TexturePoint, b: TexturePoint| (t.eval_grey(&b) - t.eval_grey(&a)) / (2.0 * h);
    let g = t.gradient(&at(u, v));
    assert!((g.x - slope(at(u - h, v), at(u + h, v))).abs() < 1e-3);
    assert!((g.y - slope(at(u, v - h), at(u, v + h))).abs() < 1e-3);
}

#[test]
fn checkerboards_start_with_the_first_colour() {
    let board = |a: [f32; 3], b: [f32; 3]| {
        let [color0, color1] = [a, b].map(|c| Box::new(TextureDesc::Constant(c)));
        Texture::compile(&TextureDesc::Checkerboard { color0, color1, to_uv: Transform::IDENTITY }).unwrap()
    };
    let t = board([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let first = [(0.1, 0.1), (0.6, 0.6), (0.5, 0.1), (-0.1, -0.1)];
    let second = [(0.6, 0.1), (0.1, 0.6), (-0.1, 0.1)];
    assert!(first.iter().all(|&(u, v)| t.eval(&at(u, v)) == Spectrum::new(1.0, 0.0, 0.0)));
    assert!(second.iter().all(|&(u, v)| t.eval(&at(u, v)) == Spectrum::new(0.0, 1.0, 0.0)));
    let grey = board([0.1; 3], [0.9; 3]);
    assert_eq!((grey.eval_grey(&at(0.1, 0.1)), grey.eval_grey(&at(0.6, 0.1))), (0.9, 0.1));
    assert_eq!(grey.mean_grey(), 0.5);
}

#[test]
fn means_and_constants() {
    let t = picture(Filter::Linear, Wrap::Repeat, Transform::IDENTITY);
    assert_near(&[t.mean_grey()], &[0.503_857_34], "mean");
    let rgb = Texture::compile(&TextureDesc::Constant([0.1, 0.2, 0.6])).unwrap();
    assert_near(&[rgb.eval_grey(&at(0.0, 0.0)), rgb.mean_grey()], &[0.3, 0.3], "constant");
    assert_eq!(Texture::compile(&TextureDesc::grey(0.1)).unwrap().eval_grey(&at(0.0, 0.0)), 0.1);
}

#[test]
fn attributes_come_from_the_mesh() {
    let mesh = Mesh {
        triangles: vec![[0, 1, 2]],
        attributes: vec![crate::scene::shape::mesh::Attribute {
            name: "vertex_color".into(),
            per_face: false,
            values: vec![Spectrum::new(1.0, 0.0, 0.0), Spectrum::new(0.0, 1.0, 0.0), Spectrum::new(0.0, 0.0, 1.0)],
        }],
        ..Mesh::default()
    };
    let t = Texture::compile(&TextureDesc::MeshAttribute { name: "vertex_color".into(), scale: 2.0 }).unwrap();
    let point = TexturePoint { mesh: Some(&mesh), barycentrics: Vec2::new(0.25, 0.5), ..at(0.0, 0.0) };
    assert_near(&t.eval(&point).to_rgb(), &[0.5, 0.5, 1.0], "attribute");
    assert!(t.eval(&at(0.0, 0.0)).is_black());
}

#[test]
fn broken_pictures_are_refused_and_wild_coordinates_are_not() {
    let image = Arc::new(ImageDesc { width: 2, height: 2, pixels: vec![[0.5; 3]; 3] });
    let (filter, wrap, to_uv) = (Filter::Linear, Wrap::Repeat, Transform::IDENTITY);
    let broken = Texture::compile(&TextureDesc::Bitmap { image, filter, wrap, to_uv });
    assert_eq!(broken.unwrap_err(), TextureError::PixelCount { width: 2, height: 2, found: 3 });
    assert_eq!(Texture::compile(&TextureDesc::grey(f32::NAN)).unwrap_err(), TextureError::NotFinite);
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        let t = picture(filter, wrap, to_uv);
        for wild in [1e30, -1e30, f32::NAN, f32::INFINITY, -1e9, 3e9] {
            let _ = (t.eval(&at(wild, wild)), t.gradient(&at(-wild, wild)));
        }
    }
}
