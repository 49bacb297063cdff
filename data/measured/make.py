"""Makes the materials of this folder, which are nobody else's, and so can be shipped.

    python data/measured/make.py               # all of them, in some ten minutes
    python data/measured/make.py car_paint     # one

Those of `TABULATED` are Mitsuba's own BSDFs, tabulated as a MERL file would hold them. The average
over both orders of the directions stands in a cell, as a MERL table is reciprocal and Mitsuba's
BSDFs need not be. Those of `MEASURED` come from `brdfkit measure`, with their standard errors.
None is one of brdfkit's models, so a fit has something to miss. To add one, write a function or a
command line like those below, and an entry in `index.toml`.

Values are rounded, or they would not compress: tabulated ones to 16 significant bits (relative
error at most 1.6e-5), measured ones to 11 bits (5e-4, far below their noise), their errors to 5.
Equal versions of Mitsuba and LLVM give equal bytes, of measured ones on equal processors.
"""

import hashlib
import io
import lzma
import shlex
import struct
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from brdfkit.cli import main
from brdfkit.core.files import write_safely
from brdfkit.materials.formats import npz
from brdfkit.materials.formats.merl import NOT_MEASURED, SCALE
from brdfkit.materials.loading import load
from brdfkit.materials.measured import Measured
from brdfkit.model.samples import Table

# Twice as many phi_d as theta_d cells: MERL's way to say that phi_d spans half a circle
SHAPE = (72, 36, 72)
BITS = 16
MEASURED_BITS, ERROR_BITS = 11, 5
# xz -9 for an array of doubles: differences of neighbours, aligned to 8 bytes
FILTERS = [
    {"id": lzma.FILTER_DELTA, "dist": 8},
    {"id": lzma.FILTER_LZMA2, "preset": 9, "lc": 1, "lp": 3, "pb": 3},
]


def red_plastic():
    """Red pigment under a rough surface: its light is scattered again and again inside."""
    return {
        "type": "roughplastic",
        "distribution": "ggx",
        "alpha": 0.12,
        "nonlinear": True,
        "diffuse_reflectance": rgb(0.78, 0.05, 0.04),
    }


def car_paint():
    """Violet flakes over a deep teal base, under a clear coat: a narrow lobe on two wide ones."""
    base = {
        "type": "principled",
        "base_color": rgb(0.01, 0.25, 0.42),
        "metallic": 0.7,
        "roughness": 0.65,
    }
    flakes = {
        "type": "principled",
        "base_color": rgb(0.68, 0.12, 0.78),
        "metallic": 1.0,
        "roughness": 0.42,
    }
    # the clear coat of `principled` has a quarter of the strength and drowns in the flakes
    coat = {
        "type": "roughplastic",
        "distribution": "ggx",
        "alpha": 0.025,
        "int_ior": 1.9,
        "diffuse_reflectance": rgb(0.0, 0.0, 0.0),
    }
    return blend(blend(base, flakes, 0.5), coat, 0.35)


def dusty_gold():
    """Rough gold seen through a third of dust, which has a sheen at grazing angles."""
    gold = {"type": "roughconductor", "material": "Au", "distribution": "ggx", "alpha": 0.2}
    dust = {
        "type": "principled",
        "base_color": rgb(0.45, 0.40, 0.33),
        "roughness": 0.9,
        "specular": 0.2,
        "sheen": 1.0,
        "sheen_tint": 0.5,
    }
    return blend(gold, dust, 0.35)


TABULATED = {make.__name__: make for make in (red_plastic, car_paint, dusty_gold)}

# What stands behind `brdfkit measure`
MEASURED = {
    "blasted_gold": "gaussian --slope 0.3 --facets Au --facet-alpha 0.15 --error 0.04",
    "plaster": "gaussian --slope 0.8 --facets paint:0.85,0.8,0.7 --error 0.03",
    "satin_plastic": "gaussian --slope 0.15 --facets plastic:0.02,0.25,0.2 --facet-alpha 0.1",
    "brushed_aluminium": "brushed --slope 0.3 --stretch 10 --facets Al --facet-alpha 0.15 "
    "--shape 24,15,12,18",
    "gold_brocade": "woven --slope 0.2 --thickness 0.7 --facets plastic:0.35,0.02,0.06 --facets Au "
    "--facet-alpha 0.15 --shape 24,15,12,18 --error 0.1",
}


def rgb(*values):
    return {"type": "rgb", "value": list(values)}


def blend(first, second, share):
    """(1 - share) of the first BSDF and `share` of the second."""
    return {"type": "blendbsdf", "weight": share, "bsdf_0": first, "bsdf_1": second}


def tabulate(name):
    """BRDF (*SHAPE, 3) in sr⁻¹ of a material at the cell centres, NaN below the surface.

    In the current variant of Mitsuba, which should be one of the RGB ones.
    """
    import mitsuba as mi

    bsdf = mi.load_dict(TABULATED[name]())
    values = np.full((*SHAPE, 3), np.nan)
    wi, wo = Table(values).directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    wi, wo = wi[above], wo[above]
    values[above] = (evaluate(bsdf, wi, wo) + evaluate(bsdf, wo, wi)) / 2
    return values


def evaluate(bsdf, wi, wo):
    """BRDF (n, 3) in sr⁻¹ of a Mitsuba BSDF, whose `eval` has the cosine of `wo` in it."""
    import mitsuba as mi

    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(wi.T.astype(np.float32))
    values = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(wo.T.astype(np.float32)))
    return np.array(values).T / wo[:, 2:]


def encoded(values):
    """The bytes of a MERL file with these values, rounded."""
    stored = np.where(np.isnan(values), NOT_MEASURED, rounded(values / SCALE))
    planes = np.moveaxis(stored, -1, 0).astype("<f8")
    return struct.pack("<3i", *SHAPE) + planes.tobytes()


def measured(name, *more):
    """What `brdfkit measure` finds, with `more` words on its command line."""
    with TemporaryDirectory() as folder:
        path = Path(folder, f"{name}.npz")
        words = ["measure", *shlex.split(MEASURED[name]), *more, "--quiet", "--output", str(path)]
        main(words, standalone_mode=False)
        return load(path)


def packed(material):
    """The bytes of a `.npz` file with the values and errors of a measurement, rounded."""
    values = material.table.values
    errors = material.standard_error.reshape(values.shape)
    stream = io.BytesIO()
    npz.write(
        Measured.from_table(
            rounded(values, MEASURED_BITS),
            name=material.name,
            info=material.info,
            standard_error=rounded(errors, ERROR_BITS),
        ),
        stream,
    )
    return stream.getvalue()


def rounded(x, bits=BITS):
    """To significant bits."""
    mantissa, exponent = np.frexp(x)
    return np.ldexp(np.round(np.ldexp(mantissa, bits)), exponent - bits)


if __name__ == "__main__":
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    for name in sys.argv[1:] or [*TABULATED, *MEASURED]:
        if name in TABULATED:
            suffix, data = ".binary.xz", encoded(tabulate(name))
        else:
            suffix, data = ".npz.xz", packed(measured(name))
        path = Path(__file__).with_name(name + suffix)
        with write_safely(path) as beside, lzma.open(beside, "wb", filters=FILTERS) as stream:
            stream.write(data)
        checksum = hashlib.sha256(path.read_bytes()).hexdigest()
        print(f"{path.name}: {path.stat().st_size:,} bytes, sha256 {checksum}")
