//! Small scenes with known answers, as Mitsuba 3 XML.
//!
//! Every scene is seen by one narrow ray (a perspective camera of 0.01 degrees and 4 x 4 pixels), so the mean of all its
//! pixels is one radiance. (The ray starts at the near clipping plane: a camera in a medium would miss the default 0.01
//! of it, one per cent at sigma_t = 1.) The boxes of media have index-matched (`null`) walls unless the name says glass.

use crate::closed_form::{SLABS, Slab, ray_radiance, ray_radiance_hg, ray_radiance_total};

/// A scene and its answer.
#[derive(Clone, Debug)]
pub struct Case {
    /// A name fit for a file.
    pub name: String,
    /// The scene. It names its side files without a folder.
    pub xml: String,
    /// Side files: name and content.
    pub files: Vec<(&'static str, Vec<u8>)>,
    /// Radiance [W/(m^2 sr)] along the ray, per channel.
    pub radiance: [f64; 3],
    /// Uncertainty of that, where it is itself measured.
    pub error: f64,
}

/// All cases below with the parameters that the literature tabulates, and a few more.
pub fn all() -> Vec<Case> {
    let mut cases = vec![
        infinite("single", &Infinite { orders: Some(1), ..Infinite::default() }),
        infinite("double", &Infinite { orders: Some(2), ..Infinite::default() }),
        infinite("multiple", &Infinite { orders: None, ..Infinite::default() }),
        infinite("near", &Infinite { a: 2.0, h: 0.1, orders: Some(1), ..Infinite::default() }),
        infinite("abreast", &Infinite { a: 0.0, h: 0.5, orders: None, albedo: [0.9, 0.8, 0.5], ..Infinite::default() }),
        infinite("forward", &Infinite { g: 0.8, orders: Some(1), ..Infinite::default() }),
        infinite("backward", &Infinite { g: -0.5, orders: Some(1), ..Infinite::default() }),
        infinite("chromatic", &CHROMATIC),
        infinite("chromatic-triple", &Infinite { orders: Some(3), ..CHROMATIC }),
        absorbing_box(),
        absorbing_ramp(),
        square_light(),
        furnace("isotropic", Furnace::default()),
        furnace("forward", Furnace { g: 0.7, ..Furnace::default() }),
        furnace("glass", Furnace { glass: true, ..Furnace::default() }),
        furnace("chromatic", Furnace { sigma_t: [3.0, 1.0, 0.3], ..Furnace::default() }),
        furnace("ramp", Furnace { ramp: true, ..Furnace::default() }),
        furnace("lens", Furnace { lens: true, sigma_t: [0.7; 3], ..Furnace::default() }),
        furnace_room(0.5),
    ];
    cases.extend(SLABS.iter().filter(|s| !s.diffuse).flat_map(slab));
    cases
}

/// The XML around the parts of a scene; the camera looks from `eye` at `target` and stands in the medium `inside`.
fn scene(eye: [f64; 3], target: [f64; 3], inside: Option<&str>, max_depth: i32, parts: &str) -> String {
    let list = |p: [f64; 3]| format!("{}, {}, {}", p[0], p[1], p[2]);
    let up = if (eye[0] - target[0]).abs() + (eye[2] - target[2]).abs() > 0.0 { "0, 1, 0" } else { "0, 0, 1" };
    let inside = inside.map(|id| format!("<ref id=\"{id}\"/>")).unwrap_or_default();
    format!(
        r#"<scene version="3.0.0">
    <default name="spp" value="256"/>
    <integrator type="volpath"><integer name="max_depth" value="{max_depth}"/><integer name="rr_depth" value="50"/></integrator>
{parts}
    <sensor type="perspective">
        <float name="fov" value="0.01"/>
        <float name="near_clip" value="1e-6"/>
        <transform name="to_world"><lookat origin="{}" target="{}" up="{up}"/></transform>
        <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
        <film type="hdrfilm">
            <integer name="width" value="4"/><integer name="height" value="4"/>
            <string name="pixel_format" value="rgb"/><string name="component_format" value="float32"/>
            <rfilter type="box"/>
        </film>
        {inside}
    </sensor>
</scene>
"#,
        list(eye),
        list(target)
    )
}

/// A homogeneous medium of id `fog`. Colours are written within [0, 1], as the format wants, the rest as `scale`.
fn fog(sigma_t: [f64; 3], albedo: [f64; 3], g: f64) -> String {
    let scale = sigma_t.into_iter().fold(0.0, f64::max);
    let [r, gr, b] = sigma_t.map(|s| s / scale);
    let [ar, ag, ab] = albedo;
    format!(
        r#"    <medium type="homogeneous" id="fog">
        <rgb name="sigma_t" value="{r}, {gr}, {b}"/><float name="scale" value="{scale}"/>
        <rgb name="albedo" value="{ar}, {ag}, {ab}"/>
        {}
    </medium>"#,
        phase(g)
    )
}

fn phase(g: f64) -> String {
    if g == 0.0 {
        r#"<phase type="isotropic"/>"#.into()
    } else {
        format!(r#"<phase type="hg"><float name="g" value="{g}"/></phase>"#)
    }
}

const CONSTANT: &str = r#"    <emitter type="constant"><rgb name="radiance" value="1"/></emitter>"#;

/// A point light of 1 W in a medium without end, and a ray that passes it (T-infinity).
#[derive(Clone, Debug)]
pub struct Infinite {
    /// Distance from the eye to the foot of the perpendicular from the light.
    pub a: f64,
    /// Distance of the light from the ray.
    pub h: f64,
    /// Extinction.
    pub sigma_t: [f64; 3],
    /// Albedo.
    pub albedo: [f64; 3],
    /// Henyey-Greenstein asymmetry; other than 0 only with `orders: Some(1)`.
    pub g: f64,
    /// Scattering orders 1 to this, or all.
    pub orders: Option<u32>,
}

impl Default for Infinite {
    fn default() -> Self {
        Self { a: 2.0, h: 0.5, sigma_t: [1.0; 3], albedo: [0.8; 3], g: 0.0, orders: Some(1) }
    }
}

/// A chromatic one.
pub const CHROMATIC: Infinite =
    Infinite { a: 1.0, h: 1.0, sigma_t: [2.0, 1.0, 0.5], albedo: [0.9, 0.5, 0.8], g: 0.0, orders: None };

/// The scene of [`Infinite`]: a sphere of 40 mean free paths stands for infinity.
pub fn infinite(name: &str, p: &Infinite) -> Case {
    assert!(p.g == 0.0 || p.orders == Some(1), "no closed form");
    let radius = 40.0 / p.sigma_t.into_iter().fold(f64::INFINITY, f64::min);
    let parts = format!(
        r#"{}
    <shape type="sphere"><float name="radius" value="{radius}"/><bsdf type="null"/><ref name="interior" id="fog"/></shape>
    <emitter type="point"><rgb name="intensity" value="{}"/><ref id="fog"/></emitter>"#,
        fog(p.sigma_t, p.albedo, p.g),
        0.25 / std::f64::consts::PI
    );
    let depth = p.orders.map_or(-1, |n| n as i32 + 1);
    let radiance = [0, 1, 2].map(|k| {
        let (q, c) = (p.sigma_t[k], p.albedo[k]);
        let (a, h) = (p.a * q, p.h * q);
        q * q
            * match p.orders {
                Some(1) => c * ray_radiance_hg(p.g, a, h),
                Some(n) => (1..=n).map(|n| c.powi(n as i32) * ray_radiance(n, a, h)).sum(),
                None => ray_radiance_total(c, a, h),
            }
    });
    let xml = scene([-p.a, p.h, 0.0], [1.0 - p.a, p.h, 0.0], Some("fog"), depth, &parts);
    Case { name: format!("infinite-{name}"), xml, files: vec![], radiance, error: 0.0 }
}

/// An absorbing chromatic box of side 2 before a constant environment of radiance 1: Beer's law.
fn absorbing_box() -> Case {
    let sigma_t = [2.0, 1.0, 0.25];
    let parts = format!(
        r#"{}
    <shape type="cube"><bsdf type="null"/><ref name="interior" id="fog"/></shape>
{CONSTANT}"#,
        fog(sigma_t, [0.0; 3], 0.0)
    );
    let xml = scene([0.2, 0.1, 5.0], [0.2, 0.1, 0.0], None, -1, &parts);
    let radiance = sigma_t.map(|s| (-2.0 * s).exp());
    Case { name: "absorbing-box".into(), xml, files: vec![], radiance, error: 0.0 }
}

/// Voxels along z of the ramp.
const RAMP: [f32; 8] = [0.05, 0.1, 0.4, 1.0, 0.6, 0.0, 0.0, 0.3];

/// A `.vol` file of 2 x 2 x 8 voxels whose density changes along z only.
pub fn ramp_volume() -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    for n in [1i32, 2, 2, 8, 1] {
        bytes.extend(n.to_le_bytes());
    }
    for x in [0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0] {
        bytes.extend(x.to_le_bytes());
    }
    bytes.extend(RAMP.iter().flat_map(|v| [*v; 4]).flat_map(f32::to_le_bytes));
    bytes
}

/// A heterogeneous medium of id `fog` over [-1, 1]^3 from [`ramp_volume`], its density times `scale`.
fn ramp(scale: f64, albedo: f64, g: f64) -> String {
    format!(
        r#"    <medium type="heterogeneous" id="fog">
        <volume type="gridvolume" name="sigma_t">
            <string name="filename" value="ramp.vol"/>
            <transform name="to_world"><scale value="2"/><translate x="-1" y="-1" z="-1"/></transform>
        </volume>
        <float name="scale" value="{scale}"/><rgb name="albedo" value="{albedo}"/>
        {}
    </medium>"#,
        phase(g)
    )
}

/// A heterogeneous absorbing box before a constant environment of radiance 1.
fn absorbing_ramp() -> Case {
    let scale = 1.5;
    let parts = format!(
        r#"{}
    <shape type="cube"><bsdf type="null"/><ref name="interior" id="fog"/></shape>
{CONSTANT}"#,
        ramp(scale, 0.0, 0.0)
    );
    // linear between the centres, constant beyond the outer ones: the mean of the voxels; path length 2
    let mean = RAMP.iter().map(|v| f64::from(*v)).sum::<f64>() / RAMP.len() as f64;
    let radiance = [(-2.0 * scale * mean).exp(); 3];
    let xml = scene([0.2, 0.1, 5.0], [0.2, 0.1, 0.0], None, -1, &parts);
    Case { name: "absorbing-ramp".into(), xml, files: vec![("ramp.vol", ramp_volume())], radiance, error: 0.0 }
}

/// A diffuse floor under the centre of a square light of side 2 at height 1.
fn square_light() -> Case {
    let parts = r#"    <shape type="rectangle">
        <transform name="to_world"><scale value="20"/><rotate x="1" angle="-90"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.4, 0.2"/></bsdf>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="90"/><translate y="1"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>
        <emitter type="area"><rgb name="radiance" value="1, 2, 4"/></emitter>
    </shape>"#;
    // form factor from the point to a quarter of the square, times four (Howell, B-4)
    let half = 0.5f64.sqrt();
    let form = 4.0 / std::f64::consts::TAU * 2.0 * half * half.atan();
    let radiance = [0.6 * form, 0.8 * form, 0.8 * form];
    let xml = scene([0.0, 0.5, 3.0], [0.0, 0.0, 0.0], None, 2, parts);
    Case { name: "square-light".into(), xml, files: vec![], radiance, error: 0.0 }
}

/// A box of side 2 that only scatters, in a constant environment of radiance 1: nothing may show.
#[derive(Clone, Copy, Debug)]
pub struct Furnace {
    /// Extinction.
    pub sigma_t: [f64; 3],
    /// Henyey-Greenstein asymmetry.
    pub g: f64,
    /// Walls of glass instead of nothing.
    pub glass: bool,
    /// Density of [`ramp_volume`] instead of a constant.
    pub ramp: bool,
    /// A clear glass sphere in the middle.
    pub lens: bool,
}

impl Default for Furnace {
    fn default() -> Self {
        Self { sigma_t: [1.0; 3], g: 0.0, glass: false, ramp: false, lens: false }
    }
}

/// The scene of [`Furnace`].
pub fn furnace(name: &str, p: Furnace) -> Case {
    let glass =
        r#"<bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>"#;
    let wall = if p.glass { glass } else { r#"<bsdf type="null"/>"# };
    let medium = if p.ramp { ramp(3.0, 1.0, p.g) } else { fog(p.sigma_t, [1.0; 3], p.g) };
    let lens = if p.lens {
        format!(
            r#"    <shape type="sphere"><float name="radius" value="0.5"/>{glass}<ref name="exterior" id="fog"/></shape>"#
        )
    } else {
        String::new()
    };
    let parts = format!(
        r#"{medium}
    <shape type="cube">{wall}<ref name="interior" id="fog"/></shape>
{lens}
{CONSTANT}"#
    );
    let xml = scene([1.0, 0.7, 5.0], [0.2, 0.1, 0.0], None, -1, &parts);
    let files = if p.ramp { vec![("ramp.vol", ramp_volume())] } else { vec![] };
    Case { name: format!("furnace-{name}"), xml, files, radiance: [1.0; 3], error: 0.0 }
}

/// A room full of medium that only scatters, whose walls of reflectance `rho` emit `1 - rho`: radiance 1 everywhere.
pub fn furnace_room(rho: f64) -> Case {
    let parts = format!(
        r#"{}
    <shape type="cube">
        <boolean name="flip_normals" value="true"/>
        <bsdf type="diffuse"><rgb name="reflectance" value="{rho}"/></bsdf>
        <emitter type="area"><rgb name="radiance" value="{}"/><ref id="fog"/></emitter>
        <ref name="exterior" id="fog"/>
    </shape>"#,
        fog([1.0; 3], [1.0; 3], 0.0),
        1.0 - rho
    );
    let xml = scene([0.3, 0.2, 0.4], [0.1, -0.5, -1.0], Some("fog"), -1, &parts);
    Case { name: "furnace-room".into(), xml, files: vec![], radiance: [1.0; 3], error: 0.0 }
}

/// A slab lit from above by a hemisphere of radiance 1, seen at normal incidence from above and, if it is finite, from below.
///
/// By reciprocity the radiance is the part of a collimated beam at normal incidence that is reflected or transmitted.
pub fn slab(p: &Slab) -> Vec<Case> {
    let depth = if p.tau.is_finite() { p.tau } else { 60.0 };
    let wide = 2000.0;
    let wall = if p.ior == 1.0 {
        r#"<bsdf type="null"/>"#.into()
    } else {
        format!(
            r#"<bsdf type="dielectric"><float name="int_ior" value="{}"/><float name="ext_ior" value="1"/></bsdf>"#,
            p.ior
        )
    };
    let sides = [(true, p.reflected + ((p.ior - 1.0) / (p.ior + 1.0)).powi(2)), (false, p.transmitted)];
    let finite = p.tau.is_finite();
    sides
        .into_iter()
        .filter(|(above, _)| *above || finite)
        .map(|(above, value)| {
            // black below: right under the slab, or under the camera
            let black = if above { -depth - 0.01 } else { -depth - 4.0 };
            let eye = if above { 2.0 } else { -depth - 2.0 };
            let parts = format!(
                r#"{}
    <shape type="cube">
        <transform name="to_world"><scale x="{wide}" y="{}" z="{wide}"/><translate y="{}"/></transform>
        {wall}<ref name="interior" id="fog"/>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><scale value="{wide}"/><rotate x="1" angle="-90"/><translate y="{black}"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>
    </shape>
{CONSTANT}"#,
                fog([1.0; 3], [p.albedo; 3], p.g),
                0.5 * depth,
                -0.5 * depth,
            );
            let xml = scene([0.0, eye, 0.0], [0.0, -0.5 * depth, 0.0], None, -1, &parts);
            let (side, tau) = (if above { "above" } else { "below" }, if finite { p.tau.to_string() } else { "inf".into() });
            let name = format!("slab-{tau}-{}-g{}-ior{}-{side}", p.albedo, p.g, p.ior);
            Case { name, xml, files: vec![], radiance: [value; 3], error: p.error }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_answers_finite() {
        let cases = all();
        let mut names: Vec<_> = cases.iter().map(|c| c.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), cases.len());
        assert!(cases.iter().all(|c| c.radiance.iter().all(|l| l.is_finite() && *l > 0.0)));
    }
}
