"""Measures how long fits take, compared with plain NumPy in the same run: `make bench`.

A full table is a material of brdfkit at the resolution of a MERL file, of which cells below 80° are
fitted. If BRDFKIT_DATA names a folder of files, fits of 10,804 goniometer samples and of 52 CUReT
materials by 7 models are measured, too. Seconds are of this machine.
"""

import os
import sys
import time
from operator import itemgetter
from pathlib import Path

import numpy as np
import psutil
from brdfkit.theses.kurt2007.curet import NUMBERS
from brdfkit.theses.kurt2007.printed import SEVEN
from model_times import make_full_table
from rich.console import Console
from rich.table import Table as Printed
from scipy.optimize import minimize

import brdfkit as bk
from brdfkit.materials.measured.selection import select_samples

# (model, loss, robust) of the fits of a full table
TABLE = (
    ("ward_duer", "cosine", None),
    ("ward", "cosine", None),
    ("blinn_phong", "cosine", None),
    ("cook_torrance", "cosine", None),
    ("ggx", "cosine", None),
    *((name, "log", None) for name in bk.models() if name != "mixture"),
    ("ggx", "cbrt", None),
    ("ggx+ggx", "log", None),
    ("ggx+student_t", "log", None),
    ("ggx+ggx", "cbrt", None),
    ("abc+student_t", "log", None),
    ("ggx", "picture", None),
    ("ggx+ggx", "picture", None),
    ("pca_polynomial:degree=7", "plain", "bisquare"),
    ("koenderink:order=8", "plain", "bisquare"),
    ("ggx", "log", "bisquare"),
    ("ggx", "cosine", "bisquare"),
)
GONIOMETER = ("ggx", "student_t", "sgd", "lafortune", "ggx+ggx", "abc+ward")


def fit_ward_duer_with_numpy(samples):
    """Fit `ward_duer` by the loss "cosine" in a few lines of NumPy, from one start of SLSQP."""
    h = samples.wi + samples.wo
    tan2 = (h[:, 0] ** 2 + h[:, 1] ** 2) / h[:, 2] ** 2
    cos_i, cos_o = samples.wi[:, 2], samples.wo[:, 2]
    w = np.sqrt(1 - cos_i**2) * samples.weight * cos_i**2

    def error(x):
        """Return the squared loss with the best weights, at a logarithm of α, `x` (1,)."""
        alpha = np.exp(x[0])
        S = np.exp(-tan2 / alpha**2) / (4 * np.pi * alpha**2 * cos_i * cos_o)
        T = np.stack([np.full_like(S, 1 / np.pi), S])
        gram, moment = (T * w) @ T.T, (T * w) @ samples.values
        return (w @ samples.values**2).sum() - (moment * np.linalg.solve(gram, moment)).sum()

    return minimize(error, [np.log(0.2)], method="SLSQP", bounds=[(np.log(0.001), 0)])


def measure_best_time(function, times=2):
    """Return the least seconds of a warm call and its result; a long call is not repeated."""
    seconds, found = _measure_time(function)
    return (
        (seconds, found)
        if seconds > 10
        else min((_measure_time(function) for _ in range(times)), key=itemgetter(0))
    )


def _measure_time(function):
    began = time.perf_counter()
    found = function()
    return time.perf_counter() - began, found


def main():
    process = psutil.Process()
    before = process.memory_info().rss
    out, data = Console(width=120), make_full_table()
    plain, _ = measure_best_time(lambda: fit_ward_duer_with_numpy(select_samples(data, 80.0)))
    table = Printed("full table", "loss", "seconds", "plain SciPy's", "loss reached", "message")
    for model, loss, robust in TABLE:
        seconds, fit = measure_best_time(lambda: bk.fit(data, model, loss=loss, robust=robust))  # noqa: B023
        share = f"{plain / seconds:.1f} ×" if (model, loss) == ("ward_duer", "cosine") else ""
        name = " ".join(filter(None, (model, robust)))
        table.add_row(name, loss, f"{seconds:.3f}", share, f"{fit.loss:.6g}", fit.message)
    out.print(table)
    grown = (process.memory_info().rss - before) / 2**20
    out.print(f"memory that the process holds after these fits: {grown:.0f} MB more than before")
    if folder := os.environ.get("BRDFKIT_DATA"):
        goniometer = bk.load(Path(folder) / "minidiff_paints" / "C8_Silver.astm.xz")
        table = Printed("10,804 samples, log", "seconds")
        for model in GONIOMETER:
            seconds, _ = measure_best_time(lambda: bk.fit(goniometer, model))  # noqa: B023
            table.add_row(model, f"{seconds:.3f}")
        out.print(table)
        curet = [bk.load(Path(folder) / "curet" / f"abrdf.dat#{k}") for k in NUMBERS]
        for model in SEVEN.values():
            bk.fit(curet[0], model, loss="cosine")
        began = time.perf_counter()
        for model in SEVEN.values():
            for sample in curet:
                bk.fit(sample, model, loss="cosine")
        out.print(f"364 fits of CUReT: {time.perf_counter() - began:.1f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
