"""Prints the results of `brdfkit fit`: the fits to one material."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from brdfkit.cli.console import Console

if TYPE_CHECKING:
    from brdfkit.fitting.compare import Comparison
    from brdfkit.fitting.ranking import Ranking
    from brdfkit.materials.measured import Measured
    from brdfkit.regression import Fit


def print_fits(
    material: Measured,
    fits: Sequence[Fit],
    comparison: Comparison,
    console: Console,
    *,
    failed: Mapping[str, Any],
    errors: Any,
    written: Sequence[Path],
    ranking: Ranking | None,
) -> None:
    """Print fits to a material, their `comparison` and the files that were written.

    `errors` are the `ImageErrors` of the pictures, or None. Notes that all fits share come first.
    JSON also contains the errors of models that `failed`, by name, and the `ranking`.
    """
    from brdfkit.cli.rank_output import make_ranking_record
    from brdfkit.materials.auditing.data_findings import list_data_findings

    if console.as_json:
        psnr = {n: row["psnr"] for n, row in errors.by_name.items()} if errors else {}
        records = [_make_fit_record(fit, comparison, psnr) for fit in fits]
        entries: dict[str, Any] = {"material": material.name, "fits": records, "failed": failed}
        entries["measured_albedo"] = comparison.measured_albedo
        entries["ranking"] = make_ranking_record(ranking)
        console.print_json({**entries, "pictures": errors, "written": written})
        return
    shared = _find_shared_notes(fits, list_data_findings(material))
    for note in shared:
        console.output.print(f"! {note}")
    for fit in fits:
        own = tuple(note for note in fit.notes if note not in shared)
        console.output.print(f"{replace(fit, notes=own)}\n")
    console.output.print(f"{comparison}\n")
    if errors:
        console.print_image_errors(errors)
    console.print_written(written)
    if not written:
        console.output.print("Nothing was saved; -o FOLDER keeps the fits.")


def _find_shared_notes(fits: Sequence[Fit], findings: Sequence[str]) -> list[str]:
    """Return the notes of the first fit that are `findings` on the data, or that all fits have.

    A single fit shares no notes. Warnings are left out, since they are about one fit's own
    reflected light.
    """
    first, *others = fits
    notes = [note for note in first.notes if note not in first.warnings]
    shared = [note for note in notes if others and all(note in f.notes for f in others)]
    return [note for note in notes if note in shared or note in findings]


def _make_fit_record(fit: Fit, comparison: Comparison, psnr: Mapping[str, float]) -> dict[str, Any]:
    """Return a fit as a dictionary, with its errors under every loss and its PSNR, for --json."""
    return {
        "model": fit.name,
        "parameters": fit.values,
        "wavelengths": fit.wavelengths,
        "standard_errors": fit.standard_errors,
        "intervals": fit.intervals,
        "degrees_of_freedom": fit.degrees_of_freedom,
        "aic": fit.aic,
        "bic": fit.bic,
        "loss": fit.loss_name,
        "loss_label": fit.loss_label,
        "error": fit.loss,
        "errors": comparison.errors[fit.name],
        "albedos": comparison.albedos[fit.name],
        "psnr": psnr.get(fit.name),
        "albedo": fit.albedo and vars(fit.albedo),
        "effective_samples": fit.effective_samples,
        "unrepresented": fit.unrepresented,
        "at_bounds": fit.at_bounds,
        "notes": fit.notes,
        "evaluations": fit.evaluations,
        "samples": fit.samples,
        "seconds": fit.seconds,
        "message": fit.message,
        "checksum": fit.checksum,
        "versions": fit.versions,
    }
