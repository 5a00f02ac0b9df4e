//! Values that Mitsuba 3.9.1 gives.

use super::*;

fn assert_close(found: Rgb, expected: Rgb) {
    let near = |(a, b): (&f32, &f32)| (a - b).abs() <= 2e-5 * b.abs().max(0.1);
    assert!(found.iter().zip(&expected).all(near), "{found:?} is not {expected:?}");
}

/// Irradiance at right angles that a single delta emitter causes at `x`.
fn delta(kind: EmitterKind, x: [f32; 3]) -> Rgb {
    let lights = lights(&[emitter(kind, look_at())], &[]);
    lights.sample(Vec3::from_array(x), 0.5, Vec2::ZERO).map_or([0.0; 3], |s| s.radiance.to_rgb())
}

/// The 4 x 3 picture `(12 row + 3 column + channel) / 36 + 0.1`.
fn ramp() -> TextureDesc {
    let value = |p: usize, c: usize| (3 * p + c) as f32 / 36.0 + 0.1;
    let pixels = (0..12).map(|p| [0, 1, 2].map(|c| value(p, c))).collect();
    bitmap(Arc::new(ImageDesc { width: 4, height: 3, pixels }))
}

fn spot(texture: Option<TextureDesc>) -> EmitterKind {
    EmitterKind::Spot { intensity: [2.0, 3.0, 4.0], cutoff_angle: 30.0, beam_width: 18.0, texture }
}

fn projector() -> EmitterKind {
    EmitterKind::Projector { irradiance: ramp(), scale: 2.5, fov_x: 40.0, aspect: 4.0 / 3.0 }
}

#[test]
fn spot_and_projector() {
    let expected = [
        ([0.0, 0.0, 0.0], [0.1428571, 0.2142857, 0.2857143]),
        ([0.3, 0.1, -0.2], [0.1394700, 0.2092050, 0.2789401]),
        ([-0.5, 0.4, 0.2], [0.1581028, 0.2371542, 0.3162055]),
        ([1.0, 0.3, -0.9], [0.1063188, 0.1594782, 0.2126376]),
        ([-1.0, 1.3, 1.0], [0.0, 0.0, 0.0]),
        ([-0.6, 0.3, -0.2], [0.1274697, 0.1912045, 0.2549394]),
        ([2.5, 1.0, 0.0], [0.0, 0.0, 0.0]),
        ([2.0, -0.4, -0.5], [0.0107836, 0.0161754, 0.0215672]),
    ];
    for (x, irradiance) in expected {
        assert_close(delta(spot(None), x), irradiance);
    }
    let expected = [
        ([0.0, 0.0, 0.0], [0.0797619, 0.1255952, 0.1753968]),
        ([0.3, 0.1, -0.2], [0.0784886, 0.1235441, 0.1724738]),
        ([-0.5, 0.4, 0.2], [0.1078418, 0.1683503, 0.2332505]),
        ([1.0, 0.3, -0.9], [0.0623228, 0.0979142, 0.1364589]),
        ([-1.0, 1.3, 1.0], [0.0, 0.0, 0.0]),
        ([-0.6, 0.3, -0.2], [0.0888536, 0.1385916, 0.1918704]),
        ([2.5, 1.0, 0.0], [0.0, 0.0, 0.0]),
        ([2.0, -0.4, -0.5], [0.0036403, 0.0059098, 0.0084788]),
    ];
    for (x, irradiance) in expected {
        assert_close(delta(spot(Some(ramp())), x), irradiance);
    }
    let expected = [
        ([0.0, 0.0, 0.0], [0.3132243, 0.3288076, 0.3443909]),
        ([0.3, 0.1, -0.2], [0.2972704, 0.3127086, 0.3281468]),
        ([-0.5, 0.4, 0.2], [0.2082904, 0.2263709, 0.2444514]),
        ([1.0, 0.3, -0.9], [0.2225883, 0.2367100, 0.2508318]),
        ([-1.0, 1.3, 1.0], [0.0, 0.0, 0.0]),
        ([-0.6, 0.3, -0.2], [0.1490942, 0.1636398, 0.1781855]),
        ([2.5, 1.0, 0.0], [0.0, 0.0, 0.0]),
        ([2.0, -0.4, -0.5], [0.0, 0.0, 0.0]),
    ];
    for (x, irradiance) in expected {
        assert_close(delta(projector(), x), irradiance);
    }
}

#[test]
fn directional_and_point() {
    assert_close(delta(EmitterKind::Directional { irradiance: [1.0, 2.0, 3.0] }, [1.0; 3]), [1.0, 2.0, 3.0]);
    let lights = lights(&[emitter(EmitterKind::Directional { irradiance: [1.0; 3] }, look_at())], &[]);
    let towards = lights.sample(Vec3::ONE, 0.5, Vec2::ZERO).unwrap().direction;
    assert_close(towards.to_array(), [0.2672612, 0.5345225, 0.8017837]);
    assert_close(delta(EmitterKind::Point { intensity: [1.0, 2.0, 3.0] }, [1.0; 3]), [0.2, 0.4, 0.6]);
}

#[test]
fn envmap() {
    let expected = [
        [
            ([0.0, 0.0, -1.0], [0.375000, 0.843750, 1.312500]),
            ([1.0, 0.0, 0.0], [0.656250, 0.328125, 0.796875]),
            ([0.3, 0.2, -0.5], [0.702717, 0.997819, 0.922178]),
            ([-0.7, 0.4, 0.3], [0.908189, 0.401285, 0.870035]),
            ([-0.1, -0.9, 0.1], [0.656614, 1.125364, 0.797238]),
            ([0.1, 0.9, 0.2], [0.734799, 0.654698, 1.078809]),
            ([-0.3, -0.2, -0.8], [0.591270, 0.593416, 1.062166]),
            ([0.2, -0.4, 0.9], [0.695986, 0.995651, 0.686343]),
        ],
        [
            ([0.0, 0.0, -1.0], [0.942516, 0.668696, 1.137446]),
            ([1.0, 0.0, 0.0], [0.805355, 0.425061, 0.779643]),
            ([0.3, 0.2, -0.5], [0.891681, 0.482681, 0.951431]),
            ([-0.7, 0.4, 0.3], [0.489878, 0.885275, 0.606365]),
            ([-0.1, -0.9, 0.1], [0.296853, 0.697041, 0.683433]),
            ([0.1, 0.9, 0.2], [0.694872, 1.081726, 0.240876]),
            ([-0.3, -0.2, -0.8], [0.760617, 0.603729, 1.072479]),
            ([0.2, -0.4, 0.9], [1.372891, 0.523365, 0.825332]),
        ],
    ];
    for (to_world, expected) in [Transform::IDENTITY, rotation()].into_iter().zip(expected) {
        let kind = EmitterKind::Envmap { image: picture(8, 5), scale: 1.5 };
        let lights = lights(&[emitter(kind, to_world)], &[]);
        for (direction, radiance) in expected {
            assert_close(lights.radiance_escape(Vec3::from_array(direction).normalize()).to_rgb(), radiance);
        }
    }
}

#[test]
fn area_lights_emit_to_the_front() {
    let form = Form::Parallelogram(Vec3::new(-1.0, -1.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0);
    let lights = lights(&[], &[(form, [1.0, 2.0, 3.0])]);
    let hit = surface(0, Vec3::ZERO, Vec3::Z);
    assert_eq!(lights.radiance_surface(&hit, -Vec3::Z).to_rgb(), [1.0, 2.0, 3.0]);
    assert_eq!(lights.radiance_surface(&hit, Vec3::Z).to_rgb(), [0.0; 3]);
    // The density there of what the receiver (0.3, 0.1, 3) sees at (-0.4, 0.2, 0).
    let seen = surface(0, Vec3::new(-0.4, 0.2, 0.0), Vec3::Z);
    assert!((lights.pdf_hit(Vec3::new(0.3, 0.1, 3.0), &seen).0 - 2.440_080_6).abs() < 1e-5);
}
