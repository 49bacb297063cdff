"""The optima that fits should reach: `optima.csv`, made by `python tests/fitting/optima.py`.

A row is the least loss E of one model on one material, without the term for its albedo that a fit
may add. `test_optima.py` holds that no search has become worse. A row is replaced only by a lower
E, or where the loss itself is another one.
"""

import csv
import os
import sys
from pathlib import Path

import numpy as np
from brdfkit.theses.kurt2007.neural import decode_network

import brdfkit as bk
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model import labels
from brdfkit.regression import regress

LIST = Path(__file__).with_name("optima.csv")
LOSSES = "cbrt", "log", "cosine"
SHIPPED = "red_plastic", "dusty_gold", "plaster", "satin_plastic", "brushed_aluminium"
# Files under BRDFKIT_DATA
MEASURED = (
    *(f"cornell/{n}" for n in ("cayman.brdf", "acryl_blue.brdf", "krylon_blue_RGB.astm")),
    *(
        f"minidiff_paints/{n}.astm.xz"
        for n in ("C10_Copper", "C8_Silver", "C2_Black", "C3_Red", "Metal_Blue", "Char_Red")
    ),
    *(f"curet/abrdf.dat#{n}" for n in (1, 4, 12, 25, 33, 36, 44, 47, 55, 61)),
)
# Neural reconstructions of MERL's materials
RECONSTRUCTED = (
    "gold-metallic-paint",
    "chrome-steel",
    "teflon",
    "black-obsidian",
    "brass",
    "specular-violet-phenolic",
)
SHAPE = 30, 30, 60


def models():
    """Every model by itself, with the sums and orders that are asked for most."""
    return *(m for m in bk.models() if m != "mixture"), *MORE


MORE = "ggx+ggx", "koenderink:order=4", "pca_polynomial:degree=7"


def material(name):
    """The `Measured` of a name above; None where it is a file and BRDFKIT_DATA is not set."""
    if name in SHIPPED:
        return bk.load(name)
    folder = os.environ.get("BRDFKIT_DATA")
    if not folder:
        return None
    if name in MEASURED:
        return bk.load(Path(folder) / name)
    with np.load(Path(folder) / "nbrdf_derived" / "merl_nbrdf.npz") as weights:
        return reconstruction(weights[name], name)


def reconstruction(weights, name, shape=SHAPE):
    """The table of a network [Sztrajman et al. 2021] of 675 `weights`, 6-21-21-3, with ReLU."""
    table = decode_network(weights, shape)
    return bk.Measured.from_table(table.values, name=name)


def read():
    """(material, model, loss) → E of the list."""
    with LIST.open(newline="") as file:
        rows = csv.DictReader(file)
        return {(r["material"], r["model"], r["loss"]): float(r["error"]) for r in rows}


def search(model, data, loss):
    """E of a model's label on a `Measured` where the search ends."""
    samples = select_samples(data, 80.0)
    how = {"anisotropic": data.anisotropic}
    return regress(labels.model(model), samples, bk.losses.named[loss], **how).loss


def main():
    """Write the list of what this version reaches."""
    with LIST.open("w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["material", "model", "loss", "error"])
        for name in (*SHIPPED, *MEASURED, *RECONSTRUCTED):
            data = material(name)
            for model in models():
                for loss in LOSSES:
                    rows.writerow([name, model, loss, f"{search(model, data, loss):.12g}"])
            file.flush()
            print(name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
