"""Mitsuba: plugins of Mitsuba's own, so that the scene file loads without brdfkit.

Lambert's model is Mitsuba's `diffuse`. All others become a table of the plugin `measured`, a file
beside the scene file: Mitsuba has no microfacet plugin with Schlick's reflectance.
"""

from pathlib import Path

from brdfkit.exporting.filling import write_bytes, write_template
from brdfkit.exporting.ggx_sum import to_ggx_sum
from brdfkit.exporting.tables import BSDF, hold_bsdf
from brdfkit.exporting.target import Held, Target
from brdfkit.model import Model


def hold(model: Model) -> Held:
    """Return the model itself, or its table."""
    content = to_ggx_sum(model)
    if content is not None and not content.lobes and max(content.diffuse) <= 1:
        return Held(model, content)
    return hold_bsdf(model, model)


def write(held: Held, path: Path, comment: list[str]) -> list[Path]:
    """Write the scene file with the material, and the table beside it."""
    files = [path]
    if isinstance(held.content, bytes):
        files.append(write_bytes(path.with_suffix(BSDF), held.content))
        kind, entries = "measured", [("string", "filename", files[1].name)]
    else:
        colour = " ".join(map(repr, held.content.diffuse))
        kind, entries = "diffuse", [("rgb", "reflectance", colour)]
    write_template("mitsuba.xml.jinja", path, comment=comment, type=kind, entries=entries)
    return files


TARGET = Target(
    name="mitsuba",
    title="Mitsuba 3 without brdfkit",
    suffix=".xml",
    holds={
        "diffuse": "Lambert",
        "highlights": "any, in a table",
        "anisotropy": "yes",
        "else": "any, in a table",
    },
    hold=hold,
    write=write,
)
