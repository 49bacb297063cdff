"""What pbrt-v4 demands of a material of type `measured`, and its values by Mitsuba's plugin.

pbrt itself is not run. Where one of these rules is broken, it stops, or draws something else.
"""

import re

import numpy as np

from brdfkit.core.colours import compute_rgb_weights
from brdfkit.materials.formats._source import Source
from brdfkit.materials.formats.rgl import tensor_file

MATERIAL = re.compile(
    r'MakeNamedMaterial "\w+" "string type" \[ "measured" \]\s+'
    r'"string filename" \[ "((?:[^"\\]|\\.)*)" \]\n'
)
# Type of each field, and a letter for each dimension; equal letters are equal sizes
FIELDS = {
    "description": ("u1", "d"),
    "phi_i": ("f4", "p"),
    "theta_i": ("f4", "t"),
    "wavelengths": ("f4", "w"),
    "ndf": ("f4", "ab"),
    "sigma": ("f4", "ef"),
    "vndf": ("f4", "ptgh"),
    "luminance": ("f4", "ptnn"),
    "spectra": ("f4", "ptwnn"),
    "jacobian": ("u1", "1"),
}


def find_table(program):
    """Return the path of the table that the one material of a .pbrt names."""
    lines = program.read_text(encoding="utf-8").splitlines(keepends=True)
    text = "".join(line for line in lines if not line.startswith("#"))
    name = MATERIAL.fullmatch(text)[1]
    return program.with_name(re.sub(r"\\(.)", r"\1", name))


def read_fields(table):
    """Return the fields of a table by name; raise `AssertionError` where pbrt refuses them."""
    fields = tensor_file.read(Source(table, None, table.read_bytes()))
    sizes = {"1": 1}
    for name, (kind, letters) in FIELDS.items():
        array = fields[name]
        assert array.dtype == kind, name
        assert array.shape == tuple(map(sizes.setdefault, letters, array.shape)), name
    for name in ("phi_i", "theta_i", "wavelengths"):
        assert (np.diff(fields[name]) > 0).all(), name
    assert fields["jacobian"][0] == 1
    turn = fields["phi_i"][-1] - fields["phi_i"][0]
    assert sizes["p"] <= 2 or round(float(2 * np.pi / turn)) == 1, "phi_i has to span the circle"
    return fields


def evaluate(table, wavelengths, wi, wo):
    """Return the BRDF (n, 3) in sr⁻¹ by Mitsuba's `measured`, whose spectra become linear sRGB."""
    import drjit as dr
    import mitsuba as mi

    mi.set_variant("llvm_ad_spectral")
    bsdf = mi.load_dict({"type": "measured", "filename": str(table)})
    si, spectra = dr.zeros(mi.SurfaceInteraction3f, len(wi)), []
    si.wi = mi.Vector3f(np.asarray(wi).T)
    for four in np.reshape(wavelengths, (-1, 4)):
        si.wavelengths = mi.Spectrum(*map(float, four))
        values = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(np.asarray(wo).T))
        spectra.extend(np.array(values) / wo[:, 2])
    return np.transpose(spectra) @ compute_rgb_weights(wavelengths, table.name)
