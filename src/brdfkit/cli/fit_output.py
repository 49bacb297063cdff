"""What `brdfkit fit` prints: the fits, a table of their errors, or both as JSON."""

from dataclasses import replace


def print_fits(material, fits, failed, comparison, pictures, written, ranking, console):
    """Print `fits` to a `material`, first the notes that all have, then their `comparison` and the
    errors of their `pictures`, `ImageErrors` or None; as JSON with what `failed` and with the
    `ranking`, too."""
    from brdfkit.cli.rank_output import record
    from brdfkit.materials.auditing.data_findings import list_data_findings

    if console.as_json:
        psnr = {n: row["psnr"] for n, row in pictures.by_name.items()} if pictures else {}
        records = [_record(f, comparison, psnr) for f in fits]
        entries = {"material": material.name, "fits": records, "failed": failed}
        entries["measured_albedo"] = comparison.measured_albedo
        entries["ranking"] = record(ranking)
        console.json({**entries, "pictures": pictures, "written": written})
        return
    shared = _shared_notes(fits, list_data_findings(material))
    for note in shared:
        console.out.print(f"! {note}")
    own = [tuple(note for note in f.notes if note not in shared) for f in fits]
    fits = [replace(f, notes=notes) for f, notes in zip(fits, own, strict=True)]
    for shown in (*fits, comparison):
        console.out.print(str(shown))
        console.out.print()
    if pictures:
        console.print_image_errors(pictures)
    console.list_written(written)
    if not written:
        console.out.print("Nothing was saved; -o FOLDER keeps the fits.")


def _shared_notes(fits, findings):
    """The notes that are said once: those on the data, its `findings`, and others that each of
    several fits has; those on the light of a fit speak of it alone."""
    first, *others = fits
    notes = [note for note in first.notes if note not in first.warnings]
    shared = [note for note in notes if others and all(note in f.notes for f in others)]
    return [note for note in notes if note in shared or note in findings]


def _record(found, comparison, psnr):
    """A fit for JSON, with its errors under every loss and the PSNR of its picture."""
    return {
        "model": found.name,
        "parameters": found.values,
        "wavelengths": found.wavelengths,
        "standard_errors": found.standard_errors,
        "intervals": found.intervals,
        "degrees_of_freedom": found.degrees_of_freedom,
        "aic": found.aic,
        "bic": found.bic,
        "loss": found.loss_name,
        "loss_label": found.loss_label,
        "error": found.loss,
        "errors": comparison.errors[found.name],
        "albedos": comparison.albedos[found.name],
        "psnr": psnr.get(found.name),
        "albedo": found.albedo and vars(found.albedo),
        "effective_samples": found.effective_samples,
        "unrepresented": found.unrepresented,
        "at_bounds": found.at_bounds,
        "notes": found.notes,
        "evaluations": found.evaluations,
        "samples": found.samples,
        "seconds": found.seconds,
        "message": found.message,
        "checksum": found.checksum,
        "versions": found.versions,
    }
