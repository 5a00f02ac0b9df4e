"""Writes oracles.json: metrics of made-up pictures by the authors' FLIP and by plain numpy.

    pip install flip-evaluator numpy
    python oracles.py > oracles.json

The same formulas make the pictures in metrics_oracles.rs.
"""

import json

import flip_evaluator
import numpy as np


def pictures(width, height, scale):
    """A high-range reference of ramps, waves and a lamp, and a noisy, slightly wrong picture of it."""
    column, row = np.meshgrid(np.arange(width), np.arange(height))
    x, y = column.astype(float), row.astype(float)
    lamp = 40.0 * np.exp(-((x - 0.7 * width) ** 2 + (y - 0.3 * height) ** 2) / 6.0)
    squares = ((column // 8 + row // 8) % 2).astype(float)
    reference = np.stack([
        0.02 + x / width + lamp,
        0.3 + 0.25 * np.sin(0.3 * x) * np.cos(0.2 * y) + lamp,
        0.05 + 0.6 * squares + 0.8 * lamp,
    ], axis=-1)
    hashed = ((column * 31 + row * 17) % 23).astype(float)[..., None]
    noise = (hashed - 11.0) / 30.0 + np.where(hashed == 7.0, 0.9, 0.0)
    picture = reference * (1.02 + noise * np.array([1.0, -0.6, 0.8])) + 0.004 * hashed
    return (scale * reference).astype(np.float32), (scale * picture).astype(np.float32)


def measure(width, height, scale):
    reference, picture = pictures(width, height, scale)
    r, p = reference.astype(np.float64), picture.astype(np.float64)
    d = p - r
    squares = (d**2 / (r**2 + 1e-3)).mean(axis=-1).ravel()
    kept = len(squares) - int(len(squares) * 0.001)
    _, ldr, _ = flip_evaluator.evaluate(np.clip(reference, 0, 1), np.clip(picture, 0, 1), "LDR", inputsRGB=False,
                                        applyMagma=False)
    flip, hdr, found = flip_evaluator.evaluate(reference, picture, "HDR", inputsRGB=False, applyMagma=False)
    return {
        "width": width, "height": height, "scale": scale,
        "mse": (d**2).mean(),
        "relmse": squares.mean(),
        "robust": np.sort(squares)[:kept].mean(),
        "mape": (abs(d) / (abs(r) + 1e-2)).mean(),
        "smape": (abs(d) / (abs(p) + abs(r) + 1e-2)).mean(),
        "psnr": 10 * np.log10(r.max() ** 2 / (d**2).mean()),
        "ldr_flip": float(ldr),
        "hdr_flip": float(hdr),
        "hdr_corners": [float(flip[0, 0, 0]), float(flip[height // 2, width // 2, 0]), float(flip[-1, -1, 0])],
        "start": float(found["startExposure"]), "stop": float(found["stopExposure"]),
        "exposures": int(found["numExposures"]),
    }


cases = [(48, 40, 1.0), (64, 32, 0.01), (33, 57, 25.0)]
print(json.dumps([{k: (float(v) if isinstance(v, np.floating) else v) for k, v in measure(*c).items()} for c in cases], indent=2))
