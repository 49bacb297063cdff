"""OpenMATERIAL 3D of ASAM: a material, and a table of its BRDF over wavelengths and angles."""

import json
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any
from uuid import NAMESPACE_URL, uuid5

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.colours import compute_rgb_weights
from brdfkit.exporting.angle_table import AngleTable, tabulate_angles
from brdfkit.exporting.comment import LICENCE
from brdfkit.exporting.filling import to_identifier, write_text
from brdfkit.exporting.target import TABLE, Held, Target
from brdfkit.exporting.uplift import Spectral
from brdfkit.materials.formats.rgl.encoding import detect_symmetry
from brdfkit.model import Model

VERSION = "1.0.0"
SCHEMAS = f"https://raw.githubusercontent.com/asam-ev/OpenMATERIAL-3D/refs/tags/v{VERSION}/schemas"
THETA = (*range(0, 90, 5), 88, 89.5)  # polar angles [°]
AZIMUTHS = 16  # steps of half a turn, the narrower, the nearer to the mirror direction
CONVENTION = (
    "Azimuths are those of the exit direction from the direction to the light, so that the mirror "
    "direction is at pi. Between the rows, values are linear in the angles and the wavelength."
)


def hold(model: Model) -> Held:
    """Return the spectra of the model at angles, or of its mean over the azimuth."""
    spectral = Spectral(model)
    isotropic = detect_symmetry(model.eval) == 0
    theta, phi = _round_down(np.radians(THETA)), _make_azimuths()
    values = tabulate_angles(spectral.eval, theta, phi, isotropic=isotropic)
    table = AngleTable(f"table of {model.label()}", theta, phi, values)
    weights = compute_rgb_weights(spectral.wavelengths, model.name)
    drawn = replace(table, values=values @ weights)
    averaged = () if isotropic else ("averaged over the azimuth",)
    changes = "interpolated between angles", *averaged, *spectral.changes
    return Held(drawn, (spectral.wavelengths, table), changes)


def _make_azimuths() -> FloatArray:
    """Return azimuths in the whole circle, narrow at the mirror direction."""
    half = 1 - np.linspace(1, 0, AZIMUTHS + 1) ** 2
    return _round_down(np.pi * np.concatenate([half, 2 - half[-2::-1]]))


def _round_down(angles: FloatArray) -> FloatArray:
    """Return angles of six digits, as the format's limits of π/2 and 2π have them."""
    return np.floor(angles * 1e6) / 1e6


def write(held: Held, path: Path, comment: list[str]) -> list[Path]:
    """Write the material, and its table beside it."""
    licences = [line.removeprefix(LICENCE) for line in comment if line.startswith(LICENCE)]
    metadata = {
        "name": path.stem,
        "description": "\n".join((*comment, CONVENTION)),
        "materialVersion": "1.0.0",
        "openMaterial3dVersion": VERSION,
        "copyrights": ["unknown"],
        "license": "".join(licences) or "unknown",
        "authors": ["brdfkit"],
    }
    facts = {"sources": f"simulated: {comment[0]}", "typicalSensorTechnology": "camera"}
    wavelengths, rows = _list_rows(*held.content)
    brdf = {"wavelengths": wavelengths, "lookupTable": []}
    table = path.with_name(f"{to_identifier(path.stem)}_brdf.xompt")
    properties = {"brdfUris": [table.name]}
    # The table first: if there is another of this name, nothing is written
    _write(table, "material_brdf", metadata | facts, {"brdf": brdf}, ",\n".join(rows))
    _write(path, "material", metadata, {"materialProperties": properties})
    return [path, table]


def _list_rows(nanometres: tuple[float, ...], table: AngleTable) -> tuple[list[float], list[str]]:
    """Return the wavelengths [m], in order, and the rows of the table."""
    order = np.argsort(nanometres)
    wavelengths = [float(f"{nanometres[channel]:g}e-9") for channel in order]
    theta, phi = ([f"{a:.7g}" for a in angles] for angles in (table.theta, table.phi))
    places = [", ".join(angles) for angles in product(theta, theta, phi)]
    rows = [
        f"[{wavelength}, {place}, {value:.6g}]"
        for wavelength, channel in zip(wavelengths, order, strict=True)
        for place, value in zip(places, table.values[..., channel].ravel().tolist(), strict=True)
    ]
    return wavelengths, rows


def _write(
    path: Path, schema: str, metadata: dict[str, Any], content: dict[str, Any], rows: str = ""
) -> None:
    """Write a file of a `schema`, whose empty `lookupTable` gets the `rows`.

    The file's identity follows from the content, so that the same export makes the same file.
    """
    identity = str(uuid5(NAMESPACE_URL, json.dumps([schema, metadata, content, rows])))
    words = {
        "$schema": f"{SCHEMAS}/{schema}_schema.json",
        "metadata": metadata | {"uuid": identity},
    }
    text = json.dumps(words | content, ensure_ascii=False, indent=1)
    write_text(path, text.replace('"lookupTable": []', f'"lookupTable": [\n{rows}\n]') + "\n")


TARGET = Target(
    name="openmaterial",
    title="ASAM OpenMATERIAL 3D: a table of spectra",
    suffix=".xomp",
    holds=TABLE | {"highlights": "any, in a table of 5°", "anisotropy": "no"},
    hold=hold,
    write=write,
    spectral=True,
    any_form=True,
)
