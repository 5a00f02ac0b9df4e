"""Renders the reference images of the format tests with Mitsuba 3.

usage: references.py FOLDER [NAME]

Every FOLDER/NAME.xml becomes NAME.exr (mean, RGB) and NAME-variance.exr (variance of one sample, RGB), and a line of
FOLDER/references.txt: name, samples per pixel, integrator, Mitsuba's version. Side files (grids, sky) are written too.
"""

import re
import struct
import sys
import time
from pathlib import Path

import mitsuba as mi
import numpy as np

SPP = 4096
BATCH = 32


def variant():
    """The fast variant where LLVM is there, else the slow one."""
    try:
        mi.set_variant("llvm_ad_rgb")
        import drjit as dr

        dr.eval(dr.llvm.Float(1) + 1)
    except Exception as error:  # drjit raises its own kinds
        print(f"libLLVM 15 or newer is missing (Debian: libllvm19): scalar_rgb instead, a few times slower ({error})")
        mi.set_variant("scalar_rgb")


def volume(path, data):
    """A .vol file over the unit cube from [z, y, x, channel]."""
    nz, ny, nx, channels = data.shape
    head = b"VOL\x03" + struct.pack("<5i", 1, nx, ny, nz, channels) + struct.pack("<6f", 0, 0, 0, 1, 1, 1)
    path.write_bytes(head + data.astype("<f4").tobytes())


def side_files(folder):
    """Two small grids and a small sky."""
    c = (np.arange(12) + 0.5) / 12
    z, y, x = np.meshgrid(c, c, c, indexing="ij")
    ball = np.clip(1.6 - 3.2 * np.sqrt((x - 0.5) ** 2 + (y - 0.45) ** 2 + (z - 0.5) ** 2), 0, 1)
    waves = 0.5 + 0.5 * np.sin(9 * x + 2 * y) * np.sin(7 * y + 1) * np.cos(8 * z - x)
    volume(folder / "grid.vol", (ball * waves)[..., None])
    layers = np.stack([0.1 + 0.9 * y, 0.6 * np.abs(np.sin(6 * x)), 0.8 * (1 - z)], axis=-1)
    volume(folder / "grid-colour.vol", layers * np.clip(3 * ball, 0, 1)[..., None])
    u, v = np.meshgrid((np.arange(32) + 0.5) / 32, (np.arange(16) + 0.5) / 16)
    sky = np.stack([0.2 + 0.3 * v, 0.3 + 0.2 * v, 0.9 - 0.6 * v], axis=-1)
    sun = np.exp(-(((u - 0.3) / 0.05) ** 2) - ((v - 0.3) / 0.08) ** 2)
    write(folder / "sky.exr", sky + 12 * sun[..., None] * np.array([1.0, 0.8, 0.5]), "float32")


def write(path, image, component):
    bitmap = mi.Bitmap(np.ascontiguousarray(image, dtype=np.float32), mi.Bitmap.PixelFormat.RGB)
    convert = {"float32": mi.Struct.Type.Float32, "float16": mi.Struct.Type.Float16}[component]
    bitmap.convert(mi.Bitmap.PixelFormat.RGB, convert, False).write(str(path))


def render(path):
    """Mean and variance of one sample over SPP samples, the latter from the means of independent batches."""
    scene = mi.load_file(str(path))
    batches = SPP // BATCH
    total, squares = 0.0, 0.0
    for seed in range(batches):
        image = np.array(mi.render(scene, spp=BATCH, seed=seed), dtype=np.float64)[..., :3]
        total, squares = total + image, squares + image**2
    mean = total / batches
    return mean, BATCH * np.maximum(squares - batches * mean**2, 0) / (batches - 1)


def main():
    folder = Path(sys.argv[1])
    only = sys.argv[2] if len(sys.argv) > 2 else ""
    variant()
    side_files(folder)
    index = folder / "references.txt"
    lines = dict(line.split(" ", 1) for line in index.read_text().splitlines()) if index.exists() else {}
    for path in sorted(folder.glob("*.xml")):
        if only not in path.stem:
            continue
        start = time.time()
        mean, variance = render(path)
        write(folder / f"{path.stem}.exr", mean, "float32")
        write(folder / f"{path.stem}-variance.exr", np.minimum(variance, 6e4), "float16")
        name = re.search(r'name="integrator" value="(\w+)"', path.read_text()).group(1)
        lines[path.stem] = f"{SPP} {name} {mi.__version__}"
        index.write_text("".join(f"{k} {v}\n" for k, v in sorted(lines.items())))
        error = np.sqrt(variance.mean() / SPP / mean.shape[0] / mean.shape[1]) / mean.mean()
        print(f"{path.stem}: mean {mean.mean():.4f}, its error {100 * error:.3f} %, {time.time() - start:.0f} s", flush=True)


main()
