"""`brdfkit shadows`: compares shadow techniques on a scene with exact shadows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import click

import brdfkit
from brdfkit.cli.console import Console
from brdfkit.cli.errors import exit_interrupted
from brdfkit.cli.options import output_option, writing_options

# The files' names are listed because importing the techniques takes a second
FOLDER = Path(brdfkit.__file__).with_name("shadows") / "maps"


def technique_option(kind: str, default: Sequence[str], help: str) -> Any:
    """Return the option --KIND: shadow techniques by the names of files in `shadows/maps/KINDs`."""
    names = ", ".join(sorted(file.stem for file in (FOLDER / f"{kind}s").glob("[!_]*.py")))
    default_names = ", ".join(default) or "all"
    return click.option(
        f"--{kind}",
        f"{kind}s",
        multiple=True,
        default=default,
        metavar="NAME",
        help=f"{help}: {names}; repeat it for more. Default: {default_names}.",
    )


@click.command()
@click.argument("scene")
@technique_option("projection", (), "Projection of the scene to a shadow map")
@technique_option(
    "filter", ("depth", "percentage_closer", "variance", "moment"), "Filter of a shadow map"
)
@technique_option("partition", ("whole",), "Partition of the scene among shadow maps")
@click.option(
    "--other",
    "others",
    multiple=True,
    metavar="NAME",
    help="Another technique: shadow_volume or hybrid_shadow; repeat it for more.",
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
@output_option("Page to write, .html, with a sortable table and the pictures of all techniques.")
@writing_options
def shadows(
    scene: str,
    projections: tuple[str, ...],
    filters: tuple[str, ...],
    partitions: tuple[str, ...],
    others: tuple[str, ...],
    resolution: int,
    size: int,
    output: Path | None,
    console: Console,
) -> None:
    """Score shadow techniques on a scene.

    Every combination of techniques is compared with exact, ray-traced shadows, for all sensors and
    all point, spot and directional lights of the scene. SCENE is a scene file of Mitsuba (.xml) or
    the name of a scene with four views and two suns: street, foliage or objects_on_a_ground.
    """
    from brdfkit.shadows.comparison import compare
    from brdfkit.shadows.comparison.comparing import PROJECTIONS
    from brdfkit.shadows.comparison.page import require_page_path

    if output is not None:
        require_page_path(output)
    with console.progress("compare shadows") as progress:
        comparison = compare(
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
        console.print_table(comparison.columns, comparison.table())
        console.output.print(comparison.meaning)
    written = [] if output is None else [output]
    for path in written:
        with console.progress("draw pictures") as progress:
            comparison.write(path, progress)
    if console.as_json:
        each = {
            label: [asdict(one) for one in all_of] for label, all_of in comparison.scores.items()
        }
        console.print_json({"scores": each, "lights": comparison.lights, "written": written})
    else:
        console.print_written(written)
    if comparison.interrupted:
        exit_interrupted(f"{comparison.finished} of {comparison.requested} scores are finished")
