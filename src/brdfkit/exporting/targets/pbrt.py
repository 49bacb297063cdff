"""pbrt-v4: a material `measured`, and beside it the table, whose values are spectra.

pbrt's other materials have no highlight of Schlick's reflectance, and its `mix` chooses one of two
materials at random at each point.
"""

from dataclasses import replace
from pathlib import Path

from brdfkit.exporting.filling import to_identifier, write_bytes, write_template
from brdfkit.exporting.tables import BSDF, hold_bsdf
from brdfkit.exporting.target import TABLE, Held, Target
from brdfkit.exporting.uplift import Spectral
from brdfkit.model import Model


def hold(model: Model) -> Held:
    """Return the table of the model, whose azimuths span the circle as pbrt demands."""
    spectral = Spectral(model)
    held = hold_bsdf(model, spectral, whole_circle=True)
    return replace(held, changes=(*held.changes, *spectral.changes))


def write(held: Held, path: Path, comment: list[str]) -> list[Path]:
    """Write the material, and the table beside it."""
    table = write_bytes(path.with_name(f"{path.stem}_spec{BSDF}"), held.content)
    name = to_identifier(path.stem)
    write_template("material.pbrt.jinja", path, comment=comment, name=name, table=table.name)
    return [path, table]


TARGET = Target(
    name="pbrt",
    title="pbrt-v4: a table of spectra",
    suffix=".pbrt",
    holds=TABLE,
    hold=hold,
    spectral=True,
    write=write,
    any_form=True,
)
