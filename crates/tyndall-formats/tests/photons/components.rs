//! The parts of the transport, rendered one by one, make the whole.

use crate::whole_scenes::{picture_mean, scene};

const PARTS: [&str; 6] = ["emitted", "direct", "indirect", "caustic", "single", "multiple"];

fn check(integrator: &str, set: &[(&str, &str)], passes: u32) {
    let scene = scene("cornell-smoke.xml", 16);
    let render = |components: &str| {
        let mut set = set.to_vec();
        set.extend([("components", components), ("max_depth", "6")]);
        picture_mean(&scene, integrator, &set, passes, 8)
    };
    let whole = render("all");
    let parts = PARTS.map(render);
    for c in 0..3 {
        let sum: f64 = parts.iter().map(|p| p[c].0).sum();
        let variance: f64 = parts.iter().chain([&whole]).map(|p| p[c].1 * p[c].1).sum();
        let shares = parts.map(|p| p[c].0 / whole[c].0);
        let sigma = variance.sqrt();
        println!(
            "{integrator}, channel {c}: {:+.2} +- {:.2} %, {shares:.3?}",
            100.0 * (sum / whole[c].0 - 1.0),
            100.0 * sigma / whole[c].0
        );
        assert!(sigma < 0.03 * whole[c].0, "{integrator}: {sigma} is no test of {}", whole[c].0);
        assert!(
            (sum - whole[c].0).abs() < 4.0 * sigma + 1e-5 * sum,
            "{integrator}: {sum} is not {} +- {sigma}",
            whole[c].0
        );
        // A caustic needs glass or a mirror, which the scene has not.
        assert!(parts.iter().zip(PARTS).all(|(p, name)| p[c].0 > 0.0 || name == "caustic"), "{integrator}: {shares:?}");
    }
}

#[test]
fn of_the_path_tracer() {
    check("volpath", &[], 48);
}

#[test]
fn of_photon_mapping() {
    let set = [("photons", "4000"), ("radius", "0.1"), ("surface_radius", "0.1")];
    check("beams", &set, 12);
    check("bre", &set, 12);
    check("photonmap", &[set[0], set[1], set[2], ("steps", "8"), ("final_gather", "true")], 12);
}
