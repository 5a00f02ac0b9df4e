"""Races Tyndall against Mitsuba 3 on the scenes of a folder, and prints a table for each.

Every renderer runs as a whole process on the same machine in the same run. Error is relMSE = mean((I - R)^2 / (R^2 + 1e-3))
over pixels and channels, the worst 0.1 % of the pixels dropped, against R, Mitsuba's own image at many samples, kept in the
cache. Three figures: samples per CPU-second, error at 64 samples, and what it takes to reach Mitsuba's error at 64 samples; the
first two of path tracing, the last of every integrator asked for: the user of a scene may choose the one that suits it.

The reference is Mitsuba's volpath: light that it cannot find (a point or spot light through smooth glass) is missing there too.

(With `--mitsuba SCENE VARIANT SPP SEED THREADS SIZE OUT` the script is itself one such process.)
"""

import argparse
import hashlib
import os
import subprocess
import sys
import time
from pathlib import Path

SPP = 64


def mitsuba_process(scene, variant, spp, seed, threads, size, out):
    """Renders in this process, in passes small enough for the memory."""
    import drjit as dr
    import mitsuba as mi
    import numpy as np

    dr.set_thread_count(int(threads))
    mi.set_variant(variant)
    scene = mi.load_file(scene, res=size)
    spp, total = int(spp), 0.0
    passes = -(-spp // 64)
    for i in range(passes):
        total = total + np.array(mi.render(scene, spp=spp // passes, seed=int(seed) + i), dtype=np.float64)[..., :3]
    np.save(out, total / passes)


def run(command):
    """Wall and CPU seconds of a command; its output, where it fails."""
    start = time.time()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    output = process.stdout.read().decode(errors="replace")
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise RuntimeError(f"{' '.join(map(str, command))} failed:\n{output}")
    return time.time() - start, usage.ru_utime + usage.ru_stime


class Race:
    def __init__(self, options, scene):
        self.options, self.scene = options, scene
        options.cache.mkdir(parents=True, exist_ok=True)

    def mitsuba(self, variant, spp, seed=1, out=None):
        o = self.options
        out = out or o.cache / "mitsuba.npy"
        arguments = [self.scene, variant, spp, seed, o.threads, o.size, out]
        seconds = run([sys.executable, __file__, "--mitsuba", *map(str, arguments)])
        import numpy as np

        return (*seconds, np.load(out))

    def tyndall(self, spp, integrator):
        import mitsuba as mi
        import numpy as np

        mi.set_variant("scalar_rgb")
        o = self.options
        out = o.cache / "tyndall.exr"
        command = [o.tyndall, "render", self.scene, "--spp", spp, "--threads", o.threads, "--seed", 1, "-o", out]
        command += ["-D", f"res={o.size}", "--no-preview", "--quiet", "-i", integrator]
        seconds = run([str(word) for word in command])
        return (*seconds, np.array(mi.Bitmap(str(out)), dtype=np.float64)[..., :3])

    def reference(self, variant):
        """Mitsuba's image at many samples, once for each content of the scene."""
        import numpy as np

        o = self.options
        key = hashlib.sha256(self.scene.read_bytes() + f"{o.size} {o.reference_spp}".encode()).hexdigest()[:12]
        kept = o.cache / f"{self.scene.stem}-{key}.npy"
        if not kept.exists():
            print(f"rendering the reference of {self.scene.stem}, {o.reference_spp} samples, once", flush=True)
            self.mitsuba(variant, o.reference_spp, seed=100_000, out=kept)
        return np.load(kept)


def rel_mse(image, reference):
    """See the head of this file."""
    import numpy as np

    error = ((image - reference) ** 2 / (reference**2 + 1e-3)).mean(axis=-1).ravel()
    error.sort()
    return float(error[: len(error) - len(error) // 1000].mean())


def variants():
    """The variants of Mitsuba that run here, fastest first."""
    check = "import mitsuba as mi; mi.set_variant('{}'); import drjit as dr; dr.eval(mi.Float(1) + 1)"
    found = []
    for name, missing in [
        ("llvm_ad_rgb", "libLLVM is missing or too old for Mitsuba (Debian: apt install libllvm19)"),
        ("scalar_rgb", "Mitsuba 3 is missing (pip install mitsuba==3.9.1)"),
    ]:
        result = subprocess.run([sys.executable, "-c", check.format(name) if "llvm" in name else check.split(";")[0]])
        if result.returncode == 0:
            found.append(name)
        else:
            print(f"NOT RACED: Mitsuba {name}: {missing}")
    return found


def to_error(race, integrator, goal, first, tries=5):
    """Fewest samples found with which the integrator's error is at most `goal`: its samples, seconds and error."""
    best, spp = None, max(1, first)
    tested = set()
    for _ in range(tries):
        if spp in tested:
            break
        tested.add(spp)
        wall, cpu, image = race.tyndall(spp, integrator)
        error = rel_mse(image, race.truth)
        if error <= goal and (best is None or spp < best[0]):
            best = (spp, wall, cpu, error)
        # error falls about as one over the samples; aim a little under the goal
        spp = max(1, round(spp * error / goal * 1.02))
    return best


def race(options, scene, names):
    o = options
    r = Race(o, scene)
    r.truth = r.reference(names[0])
    samples = o.size * o.size * SPP
    print(f"\n{scene.stem}, {o.size} x {o.size}, {o.threads} threads, whole processes")
    head = ("renderer", "M samples/CPU s", "relMSE 64 spp", "wall s", "CPU s", "CPU s at 1 spp", "relMSE x CPU s", "mean / reference")
    print("| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
    rows = {}
    for name in [*names, "tyndall"]:
        render = lambda spp, name=name: r.tyndall(spp, "volpath") if name == "tyndall" else r.mitsuba(name, spp)
        start = render(1)[1]
        wall, cpu, image = render(SPP)
        error = rel_mse(image, r.truth)
        rows[name] = (wall, cpu, error)
        figures = f"{samples / cpu / 1e6:.2f} | {error:.4g} | {wall:.2f} | {cpu:.2f} | {start:.2f} | {error * cpu:.3g}"
        mean = image.mean() / r.truth.mean()
        print(f"| {name if name == 'tyndall' else 'Mitsuba ' + name} | {figures} | {mean:.4f} |", flush=True)
    for name in names:
        wall, cpu, error = rows[name]
        print(f"to the error of Mitsuba {name} at {SPP} samples ({error:.4g}):")
        for integrator in o.integrators.split(","):
            first = round(SPP * rows["tyndall"][2] / error) if integrator == "volpath" else 1
            found = to_error(r, integrator, error, first)
            if found is None:
                print(f"  {integrator}: not reached", flush=True)
                continue
            spp, our_wall, our_cpu, our_error = found
            print(
                f"  {integrator}: {spp} samples ({our_error:.4g}), {our_wall:.2f} s wall, {our_cpu:.2f} CPU s: "
                f"{wall / our_wall:.2f} times as fast by wall, {cpu / our_cpu:.2f} by CPU",
                flush=True,
            )


def main():
    if sys.argv[1:2] == ["--mitsuba"]:
        return mitsuba_process(*sys.argv[2:])
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=Path, required=True)
    parser.add_argument("--tyndall", type=Path, required=True)
    parser.add_argument("--cache", type=Path, required=True)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--reference-spp", type=int, default=1024)
    parser.add_argument("--integrators", default="volpath,pbre")
    parser.add_argument("only", nargs="?", default="")
    options = parser.parse_args()
    names = variants()
    if not names:
        sys.exit("nobody to race against")
    for scene in sorted(options.scenes.glob("*.xml")):
        if options.only in scene.stem:
            race(options, scene, names)


main()
