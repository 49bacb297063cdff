"""What `brdfkit fit` prints: the fits, a table of their errors, or both as JSON."""

# The losses whose errors the table of fits shows, beside that which was minimised
SHOWN = "cosine", "log", "cbrt", "plain"
# Where fits gain light, if they do [degrees]
INCIDENCES = 0, 85


def print_fits(material, fits, failed, comparison, psnr, written, ranking, console):
    """Print `fits` to a `material`, a remark on each that gains light, and their errors under
    several losses; as JSON with what `failed` and with the `ranking`, too."""
    from brdfkit.commands._ranking import record
    from brdfkit.verbs.compare import format_error

    if console.as_json:
        records = [_record(f, comparison, psnr) for f in fits]
        entries = {"material": material.name, "fits": records, "failed": failed}
        entries["ranking"] = record(ranking)
        console.json({**entries, "written": written})
        return
    for found in fits:
        console.out.print(str(found))
        if gained := _gained_light(found):
            console.out.print(f"  {gained}")
        console.out.print()
    named = {f.loss_name for f in fits}
    shown = [name for name in next(iter(comparison.errors.values())) if name in {*SHOWN, *named}]
    image = [">PSNR [dB]"] if psnr else []
    columns, rows = ["model", *(f">{name}" for name in shown), *image, ">time [s]"], []
    for found in fits:
        errors = [format_error(comparison.errors[found.name][name]) for name in shown]
        image = [f"{psnr[found.name]:.1f}"] if psnr else []
        rows.append((found.name, *errors, *image, f"{found.seconds:.2f}"))
    console.table(columns, rows, title=f"{material.name}: errors")
    console.list_written(written)


def _gained_light(found):
    """A remark on a fit that reflects more light than arrives; or nothing."""
    import numpy as np

    from brdfkit.geometry.directions import from_angles
    from brdfkit.verbs.evaluate import albedo

    for angle in INCIDENCES:
        most = albedo(found, from_angles(np.radians(angle), 0.0)).max()
        if most > 1.001:
            return f"reflects {most:.2f} of the light at {angle}°; --albedo-at-most 1 prevents it"
    return ""


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
        "error": found.loss,
        "errors": comparison.errors[found.name],
        "psnr": psnr.get(found.name),
        "at_bounds": found.at_bounds,
        "notes": found.notes,
        "evaluations": found.evaluations,
        "samples": found.samples,
        "seconds": found.seconds,
        "message": found.message,
        "checksum": found.checksum,
        "versions": found.versions,
    }
