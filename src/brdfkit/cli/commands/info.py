"""`brdfkit info`: prints and draws the properties of a measured material, a map or a volume."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.options import mend_options, output_option, writing_options
from brdfkit.core.errors import BrdfkitError


@click.command()
@click.argument("file", required=False)
@output_option(
    "Picture to write, .png, .pdf or .svg: for a measurement, a slice, the lobes and the albedo; "
    "for a map, the map; for a volume, three slices and the histograms."
)
@click.option(
    "--downsample",
    type=click.IntRange(min=1),
    metavar="N",
    help="For a volume: combine N×N×N voxels into one while the file is read.",
)
@click.option(
    "--transfer",
    metavar="NAME|FILE",
    help="For a volume: transfer function to draw over the histograms.",
)
@click.option(
    "--labels", is_flag=True, help="For a volume: treat the values as labels, not as densities."
)
@mend_options
@writing_options
def info(
    file: str | None,
    output: Path | None,
    downsample: int | None,
    transfer: str | None,
    labels: bool,
    mends: dict[str, bool],
    console: Console,
) -> None:
    """Audit a measurement, an environment map or a volume.

    The command prints the properties of FILE and what is doubtful in it: for a measured material
    angles, coverage, reciprocity, noise, albedo and more; for an environment map (.exr, .hdr) its
    brightness and the directions of its light; for a volume (.nii, .nrrd, .mha, .vti, .tif, .raw,
    .vol, a folder of DICOM or TIFF) its size, orientation and histograms.

    FILE may also be the name of a material, map or volume that brdfkit knows. Without FILE, the
    command lists what comes with brdfkit; `brdfkit data` lists public data.
    """
    from brdfkit.cli.arguments import check_figure_path, write_figure
    from brdfkit.core import catalogue
    from brdfkit.volumes import TransferFunction
    from brdfkit.volumes.loading import looks_like_volume

    if file is None:
        if output:
            raise BrdfkitError("--output draws a measurement, a map or a volume: name a FILE.")
        if mends:
            raise BrdfkitError(
                "--mirror-azimuth and --divide-by-cos mend a measurement: name a FILE."
            )
        _print_shipped_data(catalogue.list_materials(), catalogue.list_environments(), console)
        return
    if transfer and not (output and looks_like_volume(file)):
        raise BrdfkitError("--transfer is drawn over a volume: name a VOLUME, and an --output.")
    functions = [TransferFunction.load(transfer)] if transfer else []
    path = check_figure_path(output) if output else None
    read, audit = _choose_audit(file, downsample, labels, mends)
    with console.progress(f"read {file}"):
        thing = read(file)
    with console.progress("audit"):
        result = audit(thing)
    if path:
        with console.progress("draw"):
            write_figure(result.picture(*functions), path)
    print_audit(result, [path] if path else [], console)


def _choose_audit(
    file: str, downsample: int | None, labels: bool, mends: Mapping[str, bool]
) -> tuple[Callable[[str], Any], Callable[[Any], Any]]:
    """Return the functions that read and audit `file`: a map, a volume or a material."""
    from brdfkit import volumes
    from brdfkit.cli.arguments import find_measured, refuse_mends
    from brdfkit.lighting import environments
    from brdfkit.lighting.environments.map_files import looks_like_map
    from brdfkit.materials.auditing import audit
    from brdfkit.volumes.loading import looks_like_volume
    from brdfkit.volumes.summary.summary import summarise

    def read_volume(name: str) -> volumes.Volume:
        return volumes.load(name, downsample=downsample or 1, labels=labels or None)

    if looks_like_volume(file):
        refuse_mends(file, "a volume", mends)
        return read_volume, summarise
    if downsample or labels:
        raise BrdfkitError(f"{file} is no volume: --downsample and --labels are for volumes only.")
    if looks_like_map(file):
        refuse_mends(file, "an environment map", mends)
        return lambda name: name, environments.audit
    return lambda name: find_measured(name, mends), audit


def print_audit(audit: Any, written: Sequence[Path], console: Console) -> None:
    """Print the properties and doubts of an audit, and the files that were `written`."""
    if console.as_json:
        console.print_json(make_audit_record(audit, written))
        return
    notes = [(key.replace("_", " "), str(value)) for key, value in _find_notes(audit).items()]
    console.output.print(audit.name, style="bold")
    console.print_table(["", ""], list(audit.rows().items()), notes)
    for finding in audit.findings():
        console.output.print(f"! {finding}")
    console.print_written(written)


def make_audit_record(audit: Any, written: Sequence[Path]) -> dict[str, Any]:
    """Return an audit and the paths of the `written` files as a dictionary, for --json."""
    return {
        **{f.name: getattr(audit, f.name) for f in fields(audit) if f.name != "data"},
        "findings": audit.findings(),
        "info": _find_notes(audit),
        "written": written,
    }


def _find_notes(audit: Any) -> Mapping[str, Any]:
    """Return the notes that a measured file contains, by name; maps and volumes have none."""
    return getattr(audit.data, "info", {})


def _print_shipped_data(
    materials: Mapping[str, Any], environments: Mapping[str, Any], console: Console
) -> None:
    """Print the materials and environment maps that come with brdfkit."""
    if console.as_json:
        console.print_json({name: asdict(m) for name, m in {**materials, **environments}.items()})
        return
    kinds = {"material": materials, "environment map": environments}
    for kind, things in kinds.items():
        rows = [(name, m.title, m.licence) for name, m in things.items()]
        console.print_table([kind, "what it is", "licence"], rows)
    console.output.print("A name may replace a file: brdfkit fit NAME, --envmap NAME")
