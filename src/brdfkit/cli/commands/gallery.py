"""`brdfkit gallery`: one picture with a ball of each material of a folder."""

from pathlib import Path

import click

from brdfkit.cli.errors import say
from brdfkit.cli.options import writing_options
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import exit_status

SIZE = 160  # pixels of a ball's picture
KINDS = {"Measured": "measured", "Fit": "fitted", "BsdfMaterial": "Mitsuba's"}  # by their class


@click.command()
@click.argument("things", nargs=-1, required=True, metavar="FOLDER|FILE|NAME...")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default="gallery.png",
    show_default=True,
    help="Picture to write, .png.",
)
@click.option(
    "--size",
    type=click.IntRange(32, 1024),
    default=SIZE,
    show_default=True,
    help="Side of the picture of each ball [pixels].",
)
@writing_options
def gallery(things, output, size, console):
    """Show a ball of each material in one picture, under its name.

    Of a FOLDER each file that holds one material is shown, measured or a saved fit; the others are
    named. What was named itself and cannot be read makes the exit status 2. The balls are previews:
    without noise, in the light of studio. Ctrl-C keeps the balls that are finished.
    """
    from brdfkit.cli.arguments import figure_file
    from brdfkit.core.files import write_safely

    if output.suffix.lower() != ".png":
        raise BrdfkitError(f"{output}: a gallery is written as .png; choose that.")
    output = figure_file(output)
    listed = _listed(things, output)
    balls, skipped, interrupted = _balls(listed, size, console)
    if balls:
        from brdfkit.rendering.contact_sheet import contact_sheet

        sheet = contact_sheet(balls)
        with write_safely(output) as beside:
            sheet.save(beside, "PNG")
    written = [output] if balls else []
    if console.as_json:
        console.json({"materials": list(balls), "skipped": skipped, "written": written})
    else:
        console.list_written(written)
    for name, why in skipped.items():
        say(f"skipped {why}" if name in why else f"skipped {name}: {why}")
    if interrupted:
        say(f"interrupted; {len(balls)} of {len(listed)} balls are finished.")
        click.get_current_context().exit(exit_status())
    if not balls or set(skipped) & set(things):
        click.get_current_context().exit(2)


def _listed(things, output):
    """The names of materials: `things`, of folders their files, without the `output`."""
    found = []
    for thing in things:
        if not Path(thing).is_dir():
            found.append(thing)
            continue
        files = sorted(path for path in Path(thing).iterdir() if path.is_file())
        found += [str(p) for p in files if p.name[0] != "." and p.resolve() != output.resolve()]
    if not found:
        raise BrdfkitError(f"{', '.join(things)}: there are no files; name a folder with some.")
    return list(dict.fromkeys(found))


def _balls(names, size, console):
    """The pictures and lines by name, the sentences on what is no material by its name, and whether
    Ctrl-C ended it."""
    from brdfkit.core.names import make_unique
    from brdfkit.materials.resolve import to_material
    from brdfkit.rendering.previewing.preview import preview

    balls, skipped = {}, {}
    try:
        with console.progress(f"draw {len(names)} balls") as progress:
            for done, name in enumerate(names, 1):
                try:
                    found = to_material(name)
                    (picture,) = preview(found, size=size).pictures.values()
                    kind = KINDS.get(type(found).__name__, "model")
                    balls[make_unique(found.name, balls)] = picture, kind
                except BrdfkitError as error:
                    skipped[name] = str(error)
                progress(done, len(names))
    except KeyboardInterrupt:
        return balls, skipped, True
    return balls, skipped, False
