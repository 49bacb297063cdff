"""What programs draw that hold tables of values instead of formulas."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

from brdfkit.exporting.target import Held
from brdfkit.exporting.uplift import Spectral
from brdfkit.materials.formats import rgl
from brdfkit.materials.formats._source import Source
from brdfkit.materials.formats.rgl.encoding import Resolution, encode_brdf
from brdfkit.model import Model

BSDF = ".bsdf"
# The numbers of nodes of tables, isotropic and anisotropic. Models have no noise, so that fewer do
# than in the files of measured materials
SIZES = (
    Resolution(phi_i=0, theta_i=32, phi_m=1, theta_m=128, grid=64),
    Resolution(phi_i=6, theta_i=16, phi_m=64, theta_m=128, grid=32),
)


def hold_bsdf(model: Model, material: Model | Spectral, *, whole_circle: bool = False) -> Held:
    """Return what a program draws of a table of the `model` in the format of RGL, `.bsdf`.

    `material` is what the table has the values of: the model in linear sRGB, or in spectra.
    `whole_circle` says whether azimuths have to span the circle. The content is the bytes of the
    file.
    """
    stream = BytesIO()
    table = encode_brdf(material.eval, SIZES, whole_circle=whole_circle)
    rgl.write_table(material, table, stream)
    content = stream.getvalue()
    drawn = rgl.read(Source(Path(f"table of {model.label()}{BSDF}"), None, content))
    return Held(drawn.rgb, content, ("interpolated in a table",))
