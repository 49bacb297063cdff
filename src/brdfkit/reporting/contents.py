"""What a report says, as plain data for its template: the fits in their order, the one to take
first."""

from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np

from brdfkit.core.names import make_unique
from brdfkit.core.pages.images import encode_jpeg, halve
from brdfkit.core.version import __version__
from brdfkit.fitting.ranking.result import COLUMNS
from brdfkit.materials.auditing import audit
from brdfkit.regression import losses
from brdfkit.rendering.montage import colour_differences
from brdfkit.reporting import origin, parameters
from brdfkit.reporting.charts.albedos import albedo_chart, is_guessed
from brdfkit.reporting.charts.lobes import lobe_charts
from brdfkit.reporting.charts.slices import slice_charts
from brdfkit.reporting.charts.svg import errors_table
from brdfkit.reporting.pictures.picture_errors import PictureError, picture_errors
from brdfkit.reporting.pictures.pixels import for_script
from brdfkit.reporting.verdict.fit_errors import in_order, ranked_by, standings
from brdfkit.reporting.verdict.verdict import verdict


@dataclass(frozen=True, eq=False)
class Contents:
    """What a report says: `said` for its template; and for the page of many reports the `names` of
    the fits, that to take first, with its `error` by the `loss`, the `picture_errors`, the
    `findings` of the audit, the `warnings` about the light of the fits, and small pictures of the
    measurement and the first fit; and the samples per pixel that there are, and that were asked
    for."""

    said: dict[str, Any]
    material: str
    verdict: str
    names: list[str]
    loss: str
    error: float
    picture_errors: list[PictureError]
    findings: tuple[str, ...]
    warnings: list[str]
    thumbnails: list[str]
    spp: int
    requested: int

    @property
    def picture_texts(self):
        """The errors of the best fit's picture as texts."""
        return [error.text(error.values[0]) for error in self.picture_errors]


def describe(material, fits, rendering, file, path, scene, environment, ranking):
    """The `Contents` of a report of a `Measured` and its `fits`, with the `Rendering` of both.

    `file`, `path`: what was read, or None, and what is written; `scene`, `environment`: of the
    pictures;
    `ranking`: that chose a model, or None.
    """
    loss = ranked_by(fits)
    standing = standings(material, fits, loss)
    errors, differences = picture_errors(rendering), [*colour_differences(rendering).values()]
    pictures = [*rendering.pictures.values()]

    # the one to take first
    order = in_order(standing, loss)
    fits, standing = [fits[k] for k in order], [standing[k] for k in order]
    errors = {metric: error.in_order(order) for metric, error in errors.items()}
    differences = [differences[k] for k in order]
    pictures = [pictures[0], *(pictures[1 + k] for k in order)]
    names: list[str] = []
    for fit in fits:
        names.append(make_unique(fit.name, names))
    named = zip(names, fits, strict=True)
    warnings = [[f"{name}: {text}" for text in fit.warnings] for name, fit in named]

    head, more = verdict(names, standing, errors, loss, ranking)
    found = audit(material)
    known = [one for one in found.noise.relative if np.isfinite(one)]
    sigma = float(np.median(known)) if known else 0.0
    size = pictures[0].shape[0]
    how = {"spp": rendering.spp, "size": size, "seed": rendering.seed}
    how |= {"scene": scene, "environment": environment}
    command, untold = origin.command(material, file, fits, path, **how)
    lobes, noise_shown = lobe_charts(material, fits, sigma)
    said = {
        "material": material.name,
        "verdict": head,
        "more": more,
        "facts": origin.facts(material, file, **how),
        "command": command,
        "untold": untold,
        "names": names,
        "stills": [encode_jpeg(picture) for picture in pictures],
        "size": size,
        "shown": origin.scene_in_words(scene, environment),
        "captions": [_caption(errors, place) for place in range(len(names))],
        "picture_errors": [*errors.values()],
        "pixels": for_script([material.name, *names], pictures, differences),
        "errors": errors_table(standing, loss, material.rgb.albedo.means),
        "warnings": warnings,
        "meanings": {n: losses.named[n].meaning.replace("θ_", "θ") for n in standing[0].errors},
        "loss": loss,
        "ranking": ranking and _ranked(ranking),
        "lobes": lobes,
        "noise_shown": noise_shown,
        "slices": slice_charts(material, fits),
        "albedo": albedo_chart(found.albedo, fits, material.anisotropic),
        "albedo_guessed": bool(is_guessed(found.albedo).any()),
        "fits": [parameters.describe(fit, found.findings()) for fit in fits],
        "audit": found.rows(),
        "findings": found.findings(),
        "info": material.info,
        "version": __version__,
    }
    return Contents(
        said,
        material.name,
        head,
        names,
        loss,
        standing[0].errors[loss],
        [*errors.values()],
        found.findings(),
        [*chain(*warnings)],
        [encode_jpeg(halve(picture)) for picture in pictures[:2]],
        rendering.spp,
        rendering.requested,
    )


def _ranked(ranking):
    """A `Ranking` for the page: without the times, which are others each time, and the verdict
    second, for narrow screens."""
    *_, time, verdict = range(len(COLUMNS))
    shown = [0, verdict, *range(1, time)]
    rows = [[row[k] for k in shown] for row in ranking.table()]
    return {"columns": [COLUMNS[k] for k in shown], "rows": rows, "why": ranking.reason}


def _caption(errors, place):
    """A line on the picture of a fit, by its place."""
    psnr, difference = (
        error.text(error.values[place]) for error in (errors["psnr"], errors["delta_e_2000"])
    )
    return f"PSNR {psnr} dB · ΔE {difference}"
