"""`brdfkit shadows`: techniques of shadow maps on a user's scene, against exact shadows."""

from dataclasses import asdict
from pathlib import Path

import click

import brdfkit
from brdfkit.cli.errors import say
from brdfkit.cli.options import writing_options
from brdfkit.core.interrupts import exit_status

# by the names of their files: to import them takes a second
FOLDER = Path(brdfkit.__file__).with_name("shadows") / "maps"


def technique(kind, default, help):
    """An option that chooses files of a folder of `shadow_maps`, by their names."""
    names = ", ".join(sorted(file.stem for file in (FOLDER / f"{kind}s").glob("[!_]*.py")))
    usual = ", ".join(default) or "all"
    return click.option(
        f"--{kind}",
        f"{kind}s",
        multiple=True,
        default=default,
        metavar="NAME",
        help=f"{help}: {names}; may be repeated. Default: {usual}.",
    )


@click.command()
@click.argument("scene")
@technique("projection", (), "How a map sees the scene")
@technique("filter", ("depth", "percentage_closer", "variance", "moment"), "How a map is read")
@technique("partition", ("whole",), "How maps share the scene")
@click.option(
    "--other",
    "others",
    multiple=True,
    metavar="NAME",
    help="A technique without maps to look up: shadow_volume or hybrid_shadow; may be repeated.",
)
@click.option(
    "--resolution",
    default=512,
    show_default=True,
    type=click.IntRange(1, 16384),
    metavar="N",
    help="Texels along a side of each map.",
)
@click.option(
    "--size",
    default=512,
    show_default=True,
    type=click.IntRange(min=8),
    metavar="N",
    help="Side of the pictures [pixels].",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="A page, .html, with the table, to sort, and the pictures of all techniques.",
)
@writing_options
def shadows(scene, projections, filters, partitions, others, resolution, size, output, console):
    """Score shadow techniques on a scene.

    Every combination of the techniques is held to exact shadows, by rays, in all views (sensors)
    and lights of the scene, which are point, spot or directional ones. SCENE is a scene file of
    Mitsuba's (.xml) or the name of a scene with four views and two suns: street, foliage or
    objects_on_a_ground.
    """
    from brdfkit.shadows.comparison import compare
    from brdfkit.shadows.comparison.comparing import PROJECTIONS
    from brdfkit.shadows.comparison.page import require_page

    if output is not None:
        require_page(output)
    with console.progress("compare shadows") as progress:
        found = compare(
            scene,
            projections or PROJECTIONS,
            filters=filters,
            partitions=partitions,
            others=others,
            resolution=resolution,
            size=(size, size),
            progress=progress,
        )
    if not console.as_json:
        console.table(found.columns, found.table())
        console.out.print(found.meaning)
    written = [] if output is None else [output]
    for path in written:
        with console.progress("draw pictures") as progress:
            found.write(path, progress)
    if console.as_json:
        each = {label: [asdict(one) for one in all_of] for label, all_of in found.scores.items()}
        console.json({"scores": each, "lights": found.lights, "written": written})
    else:
        console.list_written(written)
    if found.interrupted:
        say(f"interrupted; {found.finished} of {found.requested} scores are finished.")
        click.get_current_context().exit(exit_status())
