"""Turns a scene of SmallUPBP (NAME.obj, NAME.mtl, NAME.obj.aux) into a Mitsuba 3 scene: OUT/NAME.xml and a mesh for each material.

    python3 xtask/python/smallupbp.py candle.obj OUT

Read are diffuse reflectances, emission, refractive indices with the media inside, and the camera. The boundary of a medium is a
smooth surface even where its index is one, as in SmallUPBP: emitters are not found through it by sampling.
"""

import math
import sys
from pathlib import Path


def materials(mtl, aux):
    """By name: what both files say of a material, and the media and the camera of the second."""
    known, media, camera, kind = {}, {}, {}, {}
    for line in mtl.read_text().splitlines() + ["#"] + aux.read_text().splitlines():
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        if words[0] in ("newmtl", "material"):
            kind = known.setdefault(words[1], {})
        elif words[0] == "medium":
            kind = media.setdefault(words[1], {})
        elif words[0].startswith(("TM_", "CAMERA_")):
            camera[words[0]] = [float(word) for word in words[1:]]
        else:
            kind[words[0]] = words[1:]
    return known, media, camera


def parts(obj):
    """By material: vertices, and faces that count them from one."""
    vertices, found, part = [], {}, None
    for line in obj.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append(" ".join(words[1:4]))
        elif words[:1] == ["usemtl"]:
            part = found.setdefault(words[1], ({}, []))
        elif words[:1] == ["f"]:
            used, faces = part
            face = [vertices[int(word.split("/")[0]) - 1] for word in words[1:]]
            faces.append([used.setdefault(vertex, len(used) + 1) for vertex in face])
    return found


def rgb(name, values):
    return f'<rgb name="{name}" value="{", ".join(values)}"/>'


def medium(name, kind):
    absorption, scattering = ([float(x) for x in kind[key]] for key in ("absorption", "scattering"))
    sigma_t = [a + s for a, s in zip(absorption, scattering)]
    albedo = [s / t if t > 0 else 0 for s, t in zip(scattering, sigma_t)]
    phase = f'<phase type="hg"><float name="g" value="{kind["g"][0]}"/></phase>'
    # Mitsuba takes colours up to one.
    scale = max(sigma_t) or 1.0
    values = rgb("sigma_t", (repr(t / scale) for t in sigma_t)) + f'<float name="scale" value="{scale}"/>'
    values += rgb("albedo", map(repr, albedo))
    return f'    <medium type="homogeneous" id="{name}">{values}{phase}</medium>\n'


def shape(name, kind):
    lines = f'    <shape type="obj" id="{name}"><string name="filename" value="{name}.obj"/>\n'
    lines += '        <boolean name="face_normals" value="true"/>\n'
    if float(kind.get("ior", ["-1"])[0]) > 0 and "mediumId" in kind:
        ior = f'<float name="int_ior" value="{kind["ior"][0]}"/><float name="ext_ior" value="1"/>'
        lines += f'        <bsdf type="dielectric">{ior}</bsdf><ref name="interior" id="{kind["mediumId"][0]}"/>\n'
    else:
        lines += f'        <bsdf type="diffuse">{rgb("reflectance", kind.get("Kd", ["0"] * 3)[:3])}</bsdf>\n'
    if any(float(x) > 0 for x in kind.get("Ke", [])):
        lines += f'        <emitter type="area">{rgb("radiance", kind["Ke"])}</emitter>\n'
    return lines + "    </shape>\n"


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    obj, out = Path(sys.argv[1]), Path(sys.argv[2])
    known, media, camera = materials(obj.with_suffix(".mtl"), Path(f"{obj}.aux"))
    out.mkdir(parents=True, exist_ok=True)
    rows = [camera[f"TM_ROW{i}"] for i in range(4)]
    at = [p - d for p, d in zip(rows[3], rows[2])]
    view, target, up = (", ".join(map(repr, v)) for v in (rows[3], at, rows[1]))
    scene = '<scene version="3.0.0">\n'
    for name, value in {"width": 64, "height": 64, "spp": 64, "max_depth": 10}.items():
        scene += f'    <default name="{name}" value="{value}"/>\n'
    scene += '    <integrator type="volpath"><integer name="max_depth" value="$max_depth"/></integrator>\n'
    scene += f'''    <sensor type="perspective">
        <float name="fov" value="{math.degrees(camera["CAMERA_FOV"][0])}"/>
        <transform name="to_world"><lookat origin="{view}" target="{target}" up="{up}"/></transform>
        <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
        <film type="hdrfilm">
            <integer name="width" value="$width"/>
            <integer name="height" value="$height"/>
            <rfilter type="box"/>
        </film>
    </sensor>\n'''
    scene += "".join(medium(name, kind) for name, kind in media.items())
    for name, (vertices, faces) in parts(obj).items():
        scene += shape(name, known[name])
        lines = [f"v {vertex}" for vertex in vertices] + ["f " + " ".join(map(str, face)) for face in faces]
        (out / f"{name}.obj").write_text("\n".join(lines) + "\n")
    (out / f"{obj.stem}.xml").write_text(scene + "</scene>\n")


main()
