//! Random parameters and directions do no harm; wrong ones are refused.

use super::*;
use proptest::prelude::*;

/// A model of the given kind from numbers in [0, 1].
fn random_model(kind: usize, x: [f32; 16]) -> Vec<BsdfDesc> {
    let color = |i: usize| rgb(x[i], x[i + 1], x[i + 2]);
    let distribution = if x[0] < 0.5 { BECKMANN } else { GGX };
    let visible = x[1] < 0.5;
    let sharp = |v: f32| v * v * v;
    let roughness = || rough(distribution, sharp(x[2]), if x[3] < 0.5 { sharp(x[2]) } else { sharp(x[4]) }, visible);
    let ior = 0.5 + 2.0 * x[5];
    let tints = || [color(6), color(9)];
    let metal = BsdfDesc::RoughConductor {
        eta: rgb(4.0 * x[6], x[7], x[8]),
        k: rgb(8.0 * x[9], x[10], x[11]),
        specular_reflectance: color(12),
        roughness: roughness(),
    };
    let rate = |v: f32| if v < 0.1 { 0.0 } else { v };
    match kind {
        0 => vec![BsdfDesc::Diffuse { reflectance: color(0) }],
        1 => vec![BsdfDesc::Dielectric {
            int_ior: ior,
            ext_ior: 1.0,
            specular_reflectance: color(6),
            specular_transmittance: color(9),
        }],
        2 => vec![BsdfDesc::ThinDielectric {
            int_ior: ior,
            ext_ior: 1.0,
            specular_reflectance: color(6),
            specular_transmittance: color(9),
        }],
        3 => vec![glass(ior, 1.001, tints(), roughness())],
        4 => vec![BsdfDesc::Conductor { eta: color(0), k: color(3), specular_reflectance: color(6) }],
        5 => vec![metal],
        6 => vec![BsdfDesc::Plastic {
            diffuse_reflectance: color(6),
            specular_reflectance: color(9),
            int_ior: 1.0 + x[5],
            ext_ior: 1.0,
            nonlinear: visible,
        }],
        7 => vec![BsdfDesc::Principled(Box::new(PrincipledDesc {
            base_color: color(0),
            roughness: grey(x[3]),
            anisotropic: grey(x[4]),
            metallic: grey(x[6]),
            spec_trans: grey(x[7]),
            eta: ior,
            spec_tint: grey(x[8]),
            sheen: grey(x[9]),
            sheen_tint: grey(x[10]),
            flatness: grey(x[11]),
            clearcoat: grey(x[12]),
            clearcoat_gloss: grey(x[13]),
            diffuse_reflectance_sampling_rate: rate(x[14]),
            main_specular_sampling_rate: rate(x[15]),
            clearcoat_sampling_rate: rate(x[5]),
        }))],
        8 => vec![BsdfDesc::PrincipledThin(Box::new(PrincipledThinDesc {
            base_color: color(0),
            roughness: grey(x[3]),
            anisotropic: grey(x[4]),
            spec_trans: grey(x[7]),
            eta: grey(1.0 + x[5]),
            spec_tint: grey(x[8]),
            sheen: grey(x[9]),
            sheen_tint: grey(x[10]),
            flatness: grey(x[11]),
            diff_trans: grey(2.0 * x[12]),
            diffuse_reflectance_sampling_rate: rate(x[13]),
            specular_reflectance_sampling_rate: rate(x[14]),
            specular_transmittance_sampling_rate: rate(x[15]),
            diffuse_transmittance_sampling_rate: rate(x[6]),
        }))],
        9 => vec![metal, BsdfDesc::Mask { opacity: grey(2.0 * x[5] - 0.5), nested: BsdfId(0) }],
        10 => vec![
            glass(ior, 1.001, tints(), roughness()),
            metal,
            BsdfDesc::Blend { weight: grey(2.0 * x[14] - 0.5), first: BsdfId(0), second: BsdfId(1) },
            BsdfDesc::TwoSided { front: BsdfId(2), back: None },
        ],
        11 => vec![
            glass(ior, 1.001, tints(), roughness()),
            BsdfDesc::NormalMap {
                normals: color(12),
                flip_invalid_normals: x[3] < 0.5,
                use_shadowing_function: x[4] < 0.5,
                nested: BsdfId(0),
            },
            BsdfDesc::BumpMap {
                height: heights(),
                scale: 20.0 * x[15] - 10.0,
                flip_invalid_normals: x[4] < 0.5,
                use_shadowing_function: x[3] < 0.5,
                nested: BsdfId(1),
            },
        ],
        _ => vec![BsdfDesc::Null],
    }
}

fn direction(u: [f32; 2]) -> Vec3 {
    crate::math::warp::square_to_sphere(u.into()).normalize()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(3000) })]

    #[test]
    fn nothing_is_negative_or_not_a_number(
        kind in 0_usize..16,
        x in prop::array::uniform16(prop_oneof![4 => 0.0_f32..=1.0, 1 => Just(0.0_f32), 1 => Just(1.0_f32)]),
        u in prop::array::uniform2(prop::array::uniform2(prop_oneof![5 => 0.0_f32..=1.0, 1 => Just(0.5_f32)])),
        v in prop::array::uniform3(prop_oneof![5 => 0.0_f32..1.0, 1 => Just(0.0_f32), 1 => Just(0.999_999_94_f32)]),
    ) {
        let tabulated = ["roughplastic-beckmann", "roughplastic-ggx", "roughplastic-all"];
        let probe = if kind < 13 { Probe::new(&random_model(kind, x)) } else { Probe::named(tabulated[kind - 13]) };
        let good = |s: Spectrum| s.is_finite() && s.min_channel() >= 0.0;
        let traits = probe.traits();
        let (wo, other) = (direction(u[0]), direction(u[1]));
        for transport in [Transport::Radiance, Transport::Importance] {
            for wi in [other, -wo, Vec3::new(-wo.x, -wo.y, wo.z), wo] {
                let (value, pdf) = probe.eval(wo, wi, transport);
                prop_assert!(good(value) && pdf >= 0.0 && pdf.is_finite(), "{wo} {wi}: {value:?} {pdf}");
                prop_assert!(traits.smooth || value.is_black() && pdf == 0.0);
            }
            if let Some(s) = probe.sample(wo, transport, v[0], Vec2::new(v[1], v[2])) {
                prop_assert!(good(s.weight) && s.pdf.0 >= 0.0 && s.pdf.0.is_finite(), "{wo}: {s:?}");
                prop_assert!((s.wi.length() - 1.0).abs() < 1e-2, "{wo}: {s:?}");
                prop_assert!(s.event.eta > 0.0 && (!s.event.transmission || traits.transmits));
                let known = if s.event.null { traits.null } else { !s.event.delta || traits.delta };
                prop_assert!(known, "{s:?} {traits:?}");
                prop_assert!(s.event.delta == (s.pdf.0 == 0.0), "{wo}: {s:?}");
            }
        }
        let through = probe.bsdfs.null_transmission(probe.root, &probe.context(), wo);
        prop_assert!(good(through) && through.max_channel() <= 1.0 && (traits.null || through.is_black()));
    }
}

#[test]
fn a_tiny_roughness_is_a_mirror() {
    let probe = Probe::new(&[copper(rough(GGX, 0.0, 0.0, true), grey(1.0))]);
    let wo = directions()[0];
    let s = probe.sample(wo, Transport::Radiance, 0.5, Vec2::new(0.3, 0.4)).unwrap();
    assert!((s.wi - Vec3::new(-wo.x, -wo.y, wo.z)).length() < 1e-3 && s.weight.is_finite() && s.pdf.0 > 1e5);
}

#[test]
fn null_parts_and_sampled_null_events_agree() {
    let probe = Probe::named("mask");
    let wo = directions()[0];
    let through = probe.bsdfs.null_transmission(probe.root, &probe.context(), wo)[0];
    assert!((through - 0.7).abs() < 1e-6);
    let null = |u: f32| probe.sample(wo, Transport::Radiance, u, Vec2::splat(0.5)).is_some_and(|s| s.event.null);
    assert!(!null(0.299) && null(0.301));
    assert!(Probe::new(&[BsdfDesc::Null]).traits().is_purely_null() && !probe.traits().is_purely_null());
}

#[test]
fn wrong_descriptions_are_refused() {
    let refused = |descs: &[BsdfDesc]| Bsdfs::compile(descs).unwrap_err();
    let itself = BsdfDesc::TwoSided { front: BsdfId(0), back: None };
    assert_eq!(refused(&[itself]), BsdfError::Nesting { index: 0 });
    let missing = BsdfDesc::Mask { opacity: grey(0.5), nested: BsdfId(3) };
    assert_eq!(refused(&[missing]), BsdfError::Missing { index: 0, nested: 3 });
    let same = glass(1.5, 1.5, [grey(1.0), grey(1.0)], rough(GGX, 0.1, 0.1, true));
    assert_eq!(
        refused(&[BsdfDesc::Null, same]).to_string(),
        "BSDF 1: refractive indices 1.5 (interior) and 1.5 (exterior) must be positive and differ"
    );
    let broken = BsdfDesc::Diffuse { reflectance: grey(f32::NAN) };
    assert_eq!(refused(&[broken]).to_string(), "BSDF 0: a texture value is not finite");
    let rough = rough_plastic(1.5, [grey(0.5), grey(1.0)], (GGX, -1.0, true), false);
    assert!(refused(&[rough]).to_string().contains("alpha is -1"));
}
