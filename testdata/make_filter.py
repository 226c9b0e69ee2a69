#!/usr/bin/env python3
"""Makes filter/filtfilt.json: noisy curves, and what SciPy's filtfilt makes of them with a second-order Butterworth filter whose cutoff is
corrected for two passes (Winter, Biomechanics and Motor Control of Human Movement). Needs python3-scipy.
"""
import json
import pathlib

import numpy as np
from scipy import signal

FOLDER = pathlib.Path(__file__).parent / "filter"
RNG = np.random.default_rng(6)


def filtered(values, cutoff_hz, fps):
    # The correction holds for the analogue frequency, from which the bilinear transform makes tan(pi f / fps).
    tangent = np.tan(np.pi * cutoff_hz / fps) / (np.sqrt(2) - 1)**0.25
    b, a = signal.butter(2, 2 / np.pi * np.arctan(tangent))
    return signal.filtfilt(b, a, values, padlen=min(9, len(values) - 1))


cases = []
for fps, cutoff_hz, frames in [(100, 6, 60), (50, 6, 40), (25, 10, 40), (240, 3, 50), (30, 6, 10), (30, 6, 9), (30, 6, 3), (30, 6, 2)]:
    time = np.arange(frames) / fps
    values = 900 + 80 * np.sin(2 * np.pi * 0.9 * time) + 200 * time + RNG.normal(0, 10, frames)
    values = np.round(values, 6)
    cases.append({"fps": fps, "cutoff_hz": cutoff_hz, "values": values.tolist(), "filtered": filtered(values, cutoff_hz, fps).tolist()})
FOLDER.mkdir(exist_ok=True)
(FOLDER / "filtfilt.json").write_text(json.dumps(cases, indent=1) + "\n")
