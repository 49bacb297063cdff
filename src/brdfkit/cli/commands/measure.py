"""`brdfkit measure`: measures microgeometry in a virtual goniometer."""

from pathlib import Path

import click

from brdfkit.cli.commands.info import print_audit
from brdfkit.cli.errors import say
from brdfkit.cli.options import writing_options
from brdfkit.core.interrupts import exit_status


@click.command()
@click.argument("geometry", metavar="gaussian|brushed|woven")
@click.option("--slope", default=0.3, show_default=True, help="Root-mean-square slope.")
@click.option("--stretch", type=float, help="brushed: length of a groove over its width.")
@click.option("--thickness", type=float, help="woven: thickness of a yarn over its width.")
@click.option(
    "--facets",
    multiple=True,
    default=["Au"],
    show_default=True,
    metavar="MATERIAL",
    help="A metal (Au, Al, Cu ...), paint:R,G,B or plastic:R,G,B; twice for warp and weft.",
)
@click.option(
    "--facet-alpha", default=0.2, show_default=True, help="Roughness of metal and plastic facets."
)
@click.option(
    "--specimen",
    default=0,
    type=click.IntRange(min=0),
    metavar="N",
    show_default=True,
    help="Seed of the random surface.",
)
@click.option(
    "--shape",
    metavar="N,N,N",
    help="Cells of the table in theta_h, theta_d, phi_d; brushed and woven: phi_h before them.",
)
@click.option("--error", default=0.05, show_default=True, help="Relative standard error to reach.")
@click.option("--spp", default=16384, show_default=True, help="Samples per cell, at most.")
@click.option("--seed", default=0, show_default=True, help="Seed of the samples.")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="File to write, .npz. Default: GEOMETRY.npz.",
)
@writing_options
def measure(
    geometry, facets, facet_alpha, specimen, shape, error, spp, seed, output, console, **relief
):
    """Measure the BRDF of microgeometry.

    A virtual goniometer: it traces paths over a rough surface, and writes a table with a standard
    error for every value. The defaults measure rough gold, in about a minute. Ctrl-C ends it early,
    with larger errors.
    """
    from brdfkit.cli import goniometer_words as words
    from brdfkit.materials.auditing import audit
    from brdfkit.materials.goniometer import measure as measure_surface
    from brdfkit.materials.loading import save

    # relief: --slope, --stretch, --thickness
    output = words.measurement_file(output or Path(f"{geometry}.npz"))
    surface = words.surface(geometry, **relief, seed=specimen)
    made_of, shape = words.facets(facets, facet_alpha), words.shape(shape)
    context = click.get_current_context()
    notes = {"command": words.command_line(context.params)}
    with console.progress(f"measure {geometry}") as progress:
        found = measure_surface(
            surface,
            made_of,
            shape=shape,
            error=error,
            spp=spp,
            name=output.stem,
            info=notes,
            seed=seed,
            progress=progress,
        )
    save(found, output)
    with console.progress("audit"):
        audited = audit(found)
    print_audit(audited, [output], console)
    if "interrupted" in found.info:
        say(f"interrupted; measured with {found.info['interrupted']}.")
        context.exit(exit_status())
