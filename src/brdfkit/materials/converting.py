"""`convert`: writes a material in another file format, and reports what the file has lost."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.extrapolation import describe_file_extrapolation
from brdfkit.materials.loading import save_and_read
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.evidence import describe_evidence
from brdfkit.materials.measured.spectrum_to_rgb import format_channels
from brdfkit.materials.measured.tabulation import ANISOTROPIC, ISOTROPIC, tabulate
from brdfkit.materials.resolve import Material, MaterialLike, to_material

# The BRDFs of a material and its converted file are compared at this number of random pairs of
# directions, at angles to the normal of at most LARGEST_ANGLE
PAIRS, LARGEST_ANGLE = 4000, np.radians(80)
LEAST_DIFFERENCE = 5e-4  # smaller relative differences, printed as 0.0 %, are not reported


@dataclass(frozen=True)
class Conversion:
    """The result of `convert`, which prints as one line: the file, and how it differs.

    Attributes
    ----------
    path : Path
        Path of the file that was written.
    changes : tuple of str
        Differences between the material and the file, each in words; empty where nothing was lost.
    """

    path: Path
    changes: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.path} ({'; '.join(self.changes) or 'nothing lost'})"


def convert(material: MaterialLike, path: str | Path) -> Conversion:
    """Write a material to a file of another format, and report how the file differs from it.

    The file is read again and compared with the material, so that no loss goes unnoticed. A model
    or a fit is first tabulated over half and difference angles, because most formats hold numbers
    alone.

    Parameters
    ----------
    material : Measured, Fit, Model, str, Path or dict
        The material, its name or path, or a BSDF's dictionary.
    path : str or Path
        The file to write; its suffix chooses the format.

    Returns
    -------
    Conversion
        The path of the file, and the `changes` in words.

    Raises
    ------
    BrdfkitError
        For an object that is no material, and for a format that cannot hold the material. Nothing
        is written then.

    Examples
    --------
    >>> print(convert("cayman.brdf", "cayman.npz"))    # doctest: +SKIP
    cayman.npz (nothing lost)
    """
    thing = to_material(material)
    if isinstance(thing, Measured):
        back = save_and_read(thing, path)
        changes = (*describe_file_extrapolation(thing, back), *list_changes(thing, back))
        return Conversion(Path(path), changes)
    data = evaluate_on_grid(thing)
    note = f"{thing.name} evaluated at {len(data.values):,} direction pairs"
    return Conversion(Path(path), (note, *list_changes(data, save_and_read(data, path))))


def evaluate_on_grid(
    thing: Material, shapes: tuple[tuple[int, ...], tuple[int, ...]] = (ISOTROPIC, ANISOTROPIC)
) -> Measured:
    """Return a fit or a model as a `Measured`, sampled at the cell centres of a table.

    Between the samples the `Measured` evaluates `thing` itself, so nothing is interpolated.
    `shapes` are the numbers of cells of the table of an isotropic and of an anisotropic material.
    """
    model: Any = getattr(thing, "model", thing)
    free = getattr(model, "free_values", {})
    anisotropic = any(v and model.parameters[name].turns for name, v in free.items())
    up = np.array([[0.0, 0.0, 1.0]])
    channels = thing.eval(up, up).shape[1]
    table = tabulate(thing.eval, channels, shapes[anisotropic])
    wi, wo = (w.reshape(-1, 3) for w in table.directions())
    values = table.values.reshape(-1, channels)
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    names = tuple(f"{nm:g}nm" for nm in getattr(model, "wavelengths", ()))
    names = names or (("Y",) if channels == 1 else ("R", "G", "B"))
    return Measured.from_samples(
        wi[above],
        wo[above],
        values[above],
        channels=names,
        name=thing.name,
        info={"model": repr(model)},
        anisotropic=anisotropic,
        lookup=thing.eval,
    )


def list_changes(before: Measured, after: Measured) -> tuple[str, ...]:
    """Return in words how a converted file, read as `after`, differs from the material `before`.

    The list names changed contents, changed BRDF values, and notes that the file lacks.
    """
    old, new = describe_contents(before), describe_contents(after)
    changes = [f"{what} {old[what]} → {new[what]}" for what in old if old[what] != new[what]]
    if difference := compare_interpolations(before, after):
        changes.append(f"between the samples: {difference}")
    if missing := [key for key in before.info if key not in after.info]:
        changes.append(f"without {', '.join(missing)}")
    return tuple(changes)


def compare_interpolations(before: Measured, after: Measured) -> str:
    """Return in words how far the interpolated BRDFs of two materials differ, or "".

    The words state the median of the relative differences at random pairs of directions, and the
    bound on 95 of 100. The result is "" for differences that are negligible, or surely absent.
    """
    if not any(data.is_table or data.has_lookup for data in (before, after)):
        return ""  # both hold samples, which are interpolated alike and were compared before
    if before.channels != after.channels:
        before, after = before.rgb, after.rgb
    pairs = draw_direction_pairs(PAIRS)
    old, new = np.broadcast_arrays(before.eval(*pairs), after.eval(*pairs))
    larger = np.maximum(old, new)
    differences = np.divide(np.abs(new - old), larger, out=np.zeros(old.shape), where=larger > 0)
    median, most = np.percentile(differences, (50, 95))
    if most < LEAST_DIFFERENCE:
        return ""
    return f"{median:.1%} in the median, 95 of 100 within {most:.1%}"


def draw_direction_pairs(count: int, seed: int = 0) -> tuple[FloatArray, FloatArray]:
    """Draw pairs of directions (count, 3), uniform in both angles, to 80° from the normal."""
    random = np.random.default_rng(seed)
    theta = random.uniform(0, LARGEST_ANGLE, (2, count))
    wi, wo = from_angles(theta, random.uniform(0, 2 * np.pi, (2, count)))
    return wi, wo


def describe_contents(data: Measured) -> dict[str, str]:
    """Describe a measured material's size, angles, values and errors, as texts by topic."""
    samples, valid, errors = data.samples, data.samples.valid, data.standard_error
    values = samples.values[valid]
    cosine = min(w[valid, 2].min() for w in (samples.wi, samples.wo))
    return {
        "kind": data.kind,
        "channels": format_channels(data.channels),
        "valid": f"{valid.sum():,} of {len(valid):,}",
        "angles": f"to {np.degrees(np.arccos(cosine)):.1f}°",
        "negative": f"{(values < 0).mean():.2%} of the values",
        "BRDF": f"{values.min():.4g} to {values.max():.4g}, median {np.median(values):.4g} sr⁻¹",
        "evidence": describe_evidence(data).get("evidence", "none"),
        "standard error": "none"
        if errors is None
        else f"{np.median(errors[valid]):.3g} sr⁻¹ in the median",
    }
