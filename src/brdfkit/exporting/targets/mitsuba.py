"""Mitsuba: plugins of Mitsuba's own, so that the scene file loads without brdfkit.

The model `lambert` is Mitsuba's `diffuse`, and `disney` its `principled`. All others become a table
of the plugin `measured`, a file beside the scene file, for RGB variants: Mitsuba has no microfacet
plugin with Schlick's reflectance and Smith's shadowing of both directions together.
"""

from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.exporting.filling import write_bytes, write_template
from brdfkit.exporting.ggx_sum import to_ggx_sum
from brdfkit.exporting.tables import BSDF, hold_bsdf
from brdfkit.exporting.target import Held, Target
from brdfkit.model import Model

PRINCIPLED = {  # parameters of `disney` → of `principled`
    "metallic": "metallic",
    "roughness": "roughness",
    "anisotropy": "anisotropic",
    "ior": "eta",
    "clearcoat": "clearcoat",
    "clearcoat_gloss": "clearcoat_gloss",
    "sheen": "sheen",
}


def hold(model: Model) -> Held:
    """Return the model itself, or its table."""
    content = to_ggx_sum(model)
    if content is not None and not content.lobes and max(content.diffuse) <= 1:
        return Held(model, ("diffuse", [_write_colour("reflectance", content.diffuse)]))
    if model.type_name() == "disney" and model.anisotropy >= 0:
        colour = _write_colour("base_color", np.broadcast_to(model.base_color, 3))
        numbers = [("float", PRINCIPLED[n], repr(getattr(model, n))) for n in PRINCIPLED]
        return Held(model, ("principled", [colour, *numbers]))
    return hold_bsdf(model, model)


def write(held: Held, path: Path, comment: list[str]) -> list[Path]:
    """Write the scene file with the material, and the table beside it."""
    files = [path]
    if isinstance(held.content, bytes):
        # In a scene file $ begins a parameter's name
        table = path.with_name(f"{path.stem.replace('$', '_')}_rgb{BSDF}")
        files.append(write_bytes(table, held.content))
        kind, entries = "measured", [("string", "filename", files[1].name)]
    else:
        kind, entries = held.content
    write_template("mitsuba.xml.jinja", path, comment=comment, type=kind, entries=entries)
    return files


def _write_colour(name: str, colour: Any) -> tuple[str, str, str]:
    """Return the entry of a colour in linear sRGB."""
    return "rgb", name, " ".join(repr(float(value)) for value in colour)


TARGET = Target(
    name="mitsuba",
    title="Mitsuba 3 without brdfkit",
    suffix=".xml",
    holds={
        "diffuse": "Lambert, `disney`; any in a table",
        "highlights": "`disney`; any in a table",
        "anisotropy": "yes",
        "else": "coat, sheen of `disney`",
    },
    hold=hold,
    write=write,
    any_form=True,
)
