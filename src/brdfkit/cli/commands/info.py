"""`brdfkit info`: prints and draws what a measured material, a map or a volume holds."""

from dataclasses import asdict, fields
from pathlib import Path

import click

from brdfkit.cli.options import mend_options, writing_options
from brdfkit.core.errors import BrdfkitError


@click.command()
@click.argument("file", required=False)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Picture to write, .png, .pdf or .svg: a slice, the lobes and the albedo; or the map; or "
    "three slices of a volume and its histograms.",
)
@click.option(
    "--downsample",
    type=click.IntRange(min=1),
    metavar="N",
    help="Make one voxel of N×N×N of a volume while it is read.",
)
@click.option(
    "--transfer",
    metavar="NAME|FILE",
    help="Transfer function to draw over the histograms of a volume.",
)
@click.option("--labels", is_flag=True, help="The values of a volume are labels, not densities.")
@mend_options
@writing_options
def info(file, output, downsample, transfer, labels, mends, console):
    """Audit a measurement, an environment map or a volume.

    Prints what FILE holds (angles, coverage, reciprocity, noise, albedo and more; of a map, its
    brightness and where its light comes from; of a volume, its size, which way it lies and its
    histograms), and what is doubtful. FILE is a measured file, a map (.exr, .hdr), a volume (.nii,
    .nrrd, .mha, .vti, .tif, .raw, .vol, a folder of DICOM or TIFF), or the name of one that brdfkit
    knows. Without FILE, lists what comes with brdfkit; `brdfkit data` lists what is public.
    """
    from brdfkit.cli.arguments import figure_file, write_figure
    from brdfkit.core import catalogue
    from brdfkit.volumes import TransferFunction
    from brdfkit.volumes.loading import looks_like_volume

    if file is None and output:
        raise BrdfkitError("--output draws a measurement, a map or a volume: name a FILE.")
    if file is None and mends:
        raise BrdfkitError("--mirror-azimuth and --divide-by-cos mend a measurement: name a FILE.")
    if file is None:
        _print_shipped(catalogue.list_materials(), catalogue.list_environments(), console)
        return
    if transfer and not (output and looks_like_volume(file)):
        raise BrdfkitError("--transfer is drawn over a volume: name a VOLUME, and an --output.")
    function = TransferFunction.load(transfer) if transfer else None
    output = output and figure_file(output)
    read, audit = _ways(file, downsample, labels, mends)
    with console.progress(f"read {file}"):
        thing = read(file)
    with console.progress("audit"):
        found = audit(thing)
    if output:
        with console.progress("draw"):
            write_figure(found.picture(*([function] if function else [])), output)
    print_audit(found, [output] if output else [], console)


def _ways(file, downsample, labels, mends):
    """The functions that read and audit what the word `file` means: a map, a volume, a material."""
    from brdfkit import volumes
    from brdfkit.cli.arguments import measured_material, refuse_mends
    from brdfkit.lighting import environments
    from brdfkit.lighting.environments.map_files import looks_like_map
    from brdfkit.materials.auditing import audit
    from brdfkit.volumes.loading import looks_like_volume
    from brdfkit.volumes.summary.summary import summarise

    if looks_like_volume(file):
        refuse_mends(file, "a volume", mends)
        how = {"downsample": downsample or 1, "labels": labels or None}
        return lambda volume: volumes.load(volume, **how), summarise
    if downsample or labels:
        raise BrdfkitError(f"{file} is no volume: --downsample and --labels are for volumes only.")
    if looks_like_map(file):
        refuse_mends(file, "an environment map", mends)
        return lambda name: name, environments.audit
    return lambda name: measured_material(name, mends), audit


def print_audit(found, written, console):
    """Print an audit: what was measured, and what is doubtful; then the files `written`."""
    if console.as_json:
        console.json(record(found, written))
        return
    notes = [(key.replace("_", " "), str(value)) for key, value in _notes(found).items()]
    console.out.print(found.name, style="bold")
    console.table(["", ""], list(found.rows().items()), notes)
    for finding in found.findings():
        console.out.print(f"! {finding}")
    console.list_written(written)


def record(found, written):
    """An audit for JSON, with the files `written`."""
    return {
        **{f.name: getattr(found, f.name) for f in fields(found) if f.name != "data"},
        "findings": found.findings(),
        "info": _notes(found),
        "written": written,
    }


def _notes(found):
    """The notes of a measured file; a map has none."""
    return getattr(found.data, "info", {})


def _print_shipped(materials, environments, console):
    if console.as_json:
        console.json({name: asdict(m) for name, m in (materials | environments).items()})
        return
    kinds = {"material": materials, "environment map": environments}
    for kind, things in kinds.items():
        rows = [(name, m.title, m.licence) for name, m in things.items()]
        console.table([kind, "what it is", "licence"], rows)
    console.out.print("Use a name where a file is asked for: brdfkit fit NAME, --envmap NAME")
