"""Collects all contents of a report as plain data for the template of its page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.names import make_unique
from brdfkit.core.pages.images import encode_jpeg, halve_picture
from brdfkit.core.version import __version__
from brdfkit.fitting.ranking import Ranking
from brdfkit.fitting.ranking.result import COLUMNS
from brdfkit.materials.auditing import audit
from brdfkit.materials.measured import Measured
from brdfkit.regression import Fit, losses
from brdfkit.rendering.montage import compute_colour_differences
from brdfkit.rendering.result import Rendering
from brdfkit.reporting.charts.albedos import draw_albedo, is_extrapolated
from brdfkit.reporting.charts.lobes import draw_lobes
from brdfkit.reporting.charts.slices import draw_slices
from brdfkit.reporting.origin import describe_provenance, describe_scene, make_command
from brdfkit.reporting.parameters import describe_fit
from brdfkit.reporting.pictures.picture_errors import PictureError, compute_picture_errors
from brdfkit.reporting.pictures.pixels import pack_pictures
from brdfkit.reporting.verdict.fit_errors import (
    choose_ranking_loss,
    compute_fit_errors,
    make_errors_table,
    order_fits,
)
from brdfkit.reporting.verdict.verdict import describe_completion, write_verdict


@dataclass(frozen=True, eq=False)
class Contents:
    """The contents of a report, as the template of the page and a page of many reports need them.

    page : the variables of the template.
    material : the name of the material.
    verdict : the sentences at the head of the report.
    names : the names of the fits, the recommended fit first.
    loss : the name of the loss that ranks the fits.
    error : the error of the recommended fit by this loss.
    picture_errors : the errors of the fits' pictures, by several metrics.
    findings : the findings of the audit of the material.
    warnings : sentences on fits that reflect too much or too little light.
    thumbnails : small pictures of the measurement and of the recommended fit, as data addresses.
    spp, requested : the number of samples per pixel in the pictures, and the requested number.
    """

    page: dict[str, Any]
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
    def picture_texts(self) -> list[str]:
        """The errors of the recommended fit's picture as texts, one for each metric."""
        return [error.format_value(error.values[0]) for error in self.picture_errors]


def collect_contents(
    material: Measured,
    fits: Sequence[Fit],
    rendering: Rendering,
    file: str | Path | None,
    path: Path,
    scene: str | Path,
    environment: str | Path | None,
    ranking: Ranking | None,
) -> Contents:
    """Return the `Contents` of a report on a material and its fits.

    `rendering`: the pictures of material and fits; `file`: the material's file, if it has one;
    `path`: the file of the report; `scene`, `environment`: scene and environment map of the
    pictures; `ranking`: the ranking of models from which the fit was chosen, if there was one.
    """
    loss = choose_ranking_loss(fits)
    errors = compute_fit_errors(material, fits, loss)
    picture_errors = compute_picture_errors(rendering)
    differences = [*compute_colour_differences(rendering).values()]
    pictures = [*rendering.pictures.values()]

    # From here on the fits are sorted, with the recommended one first
    order = order_fits(errors, loss)
    fits, errors = [fits[k] for k in order], [errors[k] for k in order]
    picture_errors = {metric: error.reorder(order) for metric, error in picture_errors.items()}
    differences = [differences[k] for k in order]
    pictures = [pictures[0], *(pictures[1 + k] for k in order)]
    names: list[str] = []
    for fit in fits:
        names.append(make_unique(fit.name, names))
    named = zip(names, fits, strict=True)
    warnings = [[f"{name}: {text}" for text in fit.warnings] for name, fit in named]

    verdict, more = write_verdict(names, errors, picture_errors, loss, ranking)
    audited = audit(material)
    more += describe_completion(audited)
    known = [sigma for sigma in audited.noise.relative if np.isfinite(sigma)]
    lobes, noise_shown = draw_lobes(material, fits, float(np.median(known)) if known else 0.0)
    size = pictures[0].shape[0]
    settings: dict[str, Any] = {"spp": rendering.spp, "size": size, "seed": rendering.seed}
    settings |= {"scene": scene, "environment": environment}
    command, missing_settings = make_command(material, file, fits, path, **settings)
    page = {
        "material": material.name,
        "verdict": verdict,
        "more": more,
        "provenance": describe_provenance(material, file, **settings),
        "command": command,
        "missing_settings": missing_settings,
        "names": names,
        "stills": [encode_jpeg(picture) for picture in pictures],
        "size": size,
        "scene": describe_scene(scene, environment),
        "captions": [_make_caption(picture_errors, k) for k in range(len(names))],
        "picture_errors": [*picture_errors.values()],
        "pixels": pack_pictures([material.name, *names], pictures, differences),
        "errors": make_errors_table(errors, loss, material.rgb.albedo.means),
        "warnings": warnings,
        "meanings": {n: losses.named[n].meaning.replace("θ_", "θ") for n in errors[0].by_loss},
        "loss": loss,
        "ranking": ranking and _describe_ranking(ranking),
        "lobes": lobes,
        "noise_shown": noise_shown,
        "completed": material.evidence is not None,
        "slices": draw_slices(material, fits),
        "albedo": draw_albedo(audited.albedo, fits, material.anisotropic),
        "albedo_extrapolated": bool(is_extrapolated(audited.albedo).any()),
        "fits": [describe_fit(fit, audited.findings()) for fit in fits],
        "audit": audited.rows(),
        "findings": audited.findings(),
        "info": material.info,
        "version": __version__,
    }
    return Contents(
        page=page,
        material=material.name,
        verdict=verdict,
        names=names,
        loss=loss,
        error=errors[0].by_loss[loss],
        picture_errors=[*picture_errors.values()],
        findings=audited.findings(),
        warnings=[*chain(*warnings)],
        thumbnails=[encode_jpeg(halve_picture(picture)) for picture in pictures[:2]],
        spp=rendering.spp,
        requested=rendering.requested or rendering.spp,
    )


def _describe_ranking(ranking: Ranking) -> dict[str, Any]:
    """Return a ranking's table for the template: columns, rows, and why its model was chosen.

    Times of the fits are left out, because with them no two reports would be equal. The verdict is
    the second column, so that narrow screens show it.
    """
    *_, time, verdict = range(len(COLUMNS))
    shown = [0, verdict, *range(1, time)]
    rows = [[row[k] for k in shown] for row in ranking.table()]
    return {"columns": [COLUMNS[k] for k in shown], "rows": rows, "why": ranking.reason}


def _make_caption(errors: Mapping[str, PictureError], number: int) -> str:
    """Return the caption of a fit's picture, with its errors; `number`: index of the fit."""
    psnr, difference = (
        error.format_value(error.values[number])
        for error in (errors["psnr"], errors["delta_e_2000"])
    )
    return f"PSNR {psnr} dB · ΔE {difference}"
