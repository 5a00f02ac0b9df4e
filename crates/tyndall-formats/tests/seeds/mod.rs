//! Small valid files of every binary and mesh format: where fuzzing starts from.

use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes, LineOrder,
    SmallVec, Vec2, WritableImage, f16,
};
use image::codecs::{hdr::HdrEncoder, jpeg::JpegEncoder, png::PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::io::{Cursor, Write};

/// Format (the name of a fuzz target) and bytes.
pub type Seed = (&'static str, Vec<u8>);

/// All of them.
pub fn all() -> Vec<Seed> {
    let mut seeds = vec![
        ("xml", XML.as_bytes().to_vec()),
        ("vol", vol()),
        ("obj", OBJ.as_bytes().to_vec()),
        ("ply", PLY_TEXT.as_bytes().to_vec()),
    ];
    seeds.extend([true, false].map(|big| ("ply", ply_binary(big))));
    seeds.extend(
        [(3, 0x1000), (4, 0x1003), (4, 0x200b)].map(|(version, flags)| ("serialized", serialized(version, flags))),
    );
    seeds.extend(exr().into_iter().map(|bytes| ("exr", bytes)));
    seeds.extend(pictures().into_iter().map(|bytes| ("image", bytes)));
    seeds
}

const XML: &str = r##"<scene version="0.6.0"><default name="g" value="0.5"/>
<integrator type="volpath"><integer name="maxDepth" value="8"/></integrator>
<sensor type="perspective"><float name="fov" value="45"/><transform name="toWorld">
<lookat origin="0,0,-5" target="0,0,0" up="0,1,0"/><rotate y="1" angle="30"/><matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"/>
</transform><film type="hdrfilm"><integer name="width" value="16"/><rfilter type="mitchell"/></film></sensor>
<bsdf type="twosided" id="b"><bsdf type="diffuse"><rgb name="reflectance" value="#ff8000"/></bsdf></bsdf>
<medium type="homogeneous" id="m"><float name="sigmaT" value="2"/><float name="albedo" value="0.5"/><phase type="hg"><float name="g" value="$g"/></phase></medium>
<shape type="sphere"><float name="radius" value="2"/><ref id="b"/><ref name="interior" id="m"/></shape>
<emitter type="constant"><spectrum name="radiance" value="400:0, 500:0.3, 700:1.1"/></emitter></scene>
"##;

const OBJ: &str = "# seed\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0 1 0.5 0\nv 1 1 0\nv 0 1e-1 2\nvt 0 0\nvt 1 0.5\nvn 0 0 1\n\
                   g part\ns 1\nusemtl red\nf 1/1/1 2/2/1 3//1 4\nf -1 -2 \\\n -3\n";

const PLY_TEXT: &str = "ply\nformat ascii 1.0\ncomment seed\nelement vertex 4\nproperty float x\nproperty double y\n\
                        property float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float u\n\
                        property float v\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
                        element face 2\nproperty list uchar int vertex_indices\nproperty float heat_x\n\
                        element edge 1\nproperty int a\nproperty list uint short b\nend_header\n\
                        0 0 0 0 0 1 0 0 255 0 1\n1 0 0 0 0 1 1 0 2 3 4\n1 1 0 0 0 1 1 1 5 6 7\n0 1 0 0 0 0 0 1 8 9 10\n\
                        4 0 1 2 3 0.5\n3 0 1 3 -1e-3\n7 2 1 1\n";

fn ply_binary(big: bool) -> Vec<u8> {
    let format = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut out = format!(
        "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         property float heat_r\nproperty float heat_g\nproperty float heat_b\nelement tag 2\nproperty list char ushort t\n\
         element face 1\nproperty list uchar uint vertex_index\nend_header\n"
    )
    .into_bytes();
    let mut put = |bytes: &mut [u8]| {
        if big {
            bytes.reverse();
        }
        out.extend_from_slice(bytes);
    };
    for i in 0..18u8 {
        put(&mut f32::from(i * i % 7).to_le_bytes());
    }
    put(&mut [1]);
    put(&mut 500u16.to_le_bytes());
    put(&mut [0]);
    put(&mut [3]);
    for i in 0..3u32 {
        put(&mut i.to_le_bytes());
    }
    out
}

fn serialized(version: u16, flags: u32) -> Vec<u8> {
    let columns = 3 + 3 * (flags & 1) + (flags & 2) + 3 * (flags >> 3 & 1);
    let mut raw = flags.to_le_bytes().to_vec();
    if version == 4 {
        raw.extend_from_slice(b"seed\0");
    }
    raw.extend([3u64, 1].iter().flat_map(|n| n.to_le_bytes()));
    for i in 0..3 * columns {
        let x = (i * i % 7) as f32;
        if flags & 0x2000 != 0 {
            raw.extend_from_slice(&f64::from(x).to_le_bytes());
        } else {
            raw.extend_from_slice(&x.to_le_bytes());
        }
    }
    raw.extend([0u32, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
    // Stored, not deflated: changes of single bytes then reach the mesh.
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::none());
    encoder.write_all(&raw).unwrap();
    let mesh = [&0x041c_u16.to_le_bytes()[..], &version.to_le_bytes(), &encoder.finish().unwrap()].concat();
    let mut file = mesh.repeat(2);
    for offset in [0, mesh.len() as u64] {
        file.extend_from_slice(&offset.to_le_bytes()[..if version == 4 { 8 } else { 4 }]);
    }
    file.extend_from_slice(&2u32.to_le_bytes());
    file
}

fn vol() -> Vec<u8> {
    let mut out = b"VOL\x03".to_vec();
    out.extend([1i32, 2, 3, 2, 1].iter().flat_map(|n| n.to_le_bytes()));
    out.extend((0..6 + 12).flat_map(|i| (i as f32).to_le_bytes()));
    out
}

fn exr() -> Vec<Vec<u8>> {
    use Compression::{B44, B44A, PIZ, PXR24, RLE, Uncompressed, ZIP1, ZIP16};
    let (width, height) = (9, 7);
    let values = |factor: f32| (0..width * height).map(move |i| factor * (i % 13) as f32);
    let file = |compression, blocks| {
        let channels = AnyChannels::sort(SmallVec::from_vec(vec![
            AnyChannel::new("R", FlatSamples::F32(values(0.5).collect())),
            AnyChannel::new("G", FlatSamples::F16(values(0.25).map(f16::from_f32).collect())),
            AnyChannel::new("variance.B", FlatSamples::U32(values(2.0).map(|x| x as u32).collect())),
            AnyChannel::new("B", FlatSamples::F16(values(2.0).map(f16::from_f32).collect())),
        ]));
        let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
        let layer = Layer::new(Vec2(width, height), LayerAttributes::default(), encoding, channels);
        let mut out = Cursor::new(Vec::new());
        Image::from_layer(layer).write().non_parallel().to_buffered(&mut out).unwrap();
        out.into_inner()
    };
    let mut files: Vec<Vec<u8>> = [Uncompressed, RLE, ZIP1, ZIP16, PIZ, PXR24, B44, B44A]
        .into_iter()
        .map(|compression| file(compression, Blocks::ScanLines))
        .collect();
    files.push(file(ZIP16, Blocks::Tiles(Vec2(4, 4))));
    files.push(file(PIZ, Blocks::Tiles(Vec2(5, 3))));
    files
}

fn pictures() -> Vec<Vec<u8>> {
    let (mut png, mut jpeg, mut hdr) = (Vec::new(), Vec::new(), Vec::new());
    let bytes: Vec<u8> = (0..8 * 8 * 3).map(|i| (i * 37 % 251) as u8).collect();
    PngEncoder::new(&mut png).write_image(&bytes, 8, 8, ExtendedColorType::Rgb8).unwrap();
    JpegEncoder::new(&mut jpeg).write_image(&bytes, 8, 8, ExtendedColorType::Rgb8).unwrap();
    let floats: Vec<image::Rgb<f32>> = bytes.chunks(3).map(|c| image::Rgb([c[0], c[1], c[2]].map(f32::from))).collect();
    HdrEncoder::new(&mut hdr).encode(&floats, 8, 8).unwrap();
    let mut pfm = b"PF\n2 2\n-1\n".to_vec();
    pfm.extend((0..12).flat_map(|i| (i as f32).to_le_bytes()));
    vec![png, jpeg, hdr, pfm]
}
