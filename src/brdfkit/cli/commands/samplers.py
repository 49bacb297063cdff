"""`brdfkit samplers`: finds the best sampler of an environment map for a material and a scene."""

from __future__ import annotations

import click

from brdfkit.cli.console import Console
from brdfkit.cli.errors import exit_interrupted
from brdfkit.cli.options import MESHES, output_options, seed_option


@click.command()
@click.argument("environment", metavar="NAME|MAP")
@click.option(
    "--material",
    default="plaster",
    show_default=True,
    metavar="NAME|FILE",
    help="The material that is lit: a measured one, a fit or a model.",
)
@click.option(
    "--scene",
    default="ball",
    show_default=True,
    metavar="SCENE",
    help=f"The scene that is lit, as for render; or {MESHES}, or FILE.obj#z if z points up.",
)
@click.option(
    "--rounds",
    type=click.IntRange(min=3),
    default=10,
    show_default=True,
    metavar="N",
    help="Number of repeats; more of them detect smaller differences.",
)
@seed_option
@output_options
def samplers(
    environment: str, material: str, scene: str, rounds: int, seed: int, console: Console
) -> None:
    """Find the sampler that suits an environment map.

    A sampler draws the points of the map that light a picture. Each one path-traces the same
    pictures. Its cost is noise × time, which is proportional to the time for a picture of given
    noise. The table says whether a difference from the best sampler is significant (Tukey's test,
    5 % for all samplers together). Times are processor times, but other work on the machine still
    disturbs them. Compensated samplers suit only path tracing, which also samples BSDFs. After
    Ctrl-C, the finished rounds are kept.
    """
    from brdfkit.rendering.map_sampling import compare_samplers
    from brdfkit.rendering.sampler_comparison import COLUMNS

    with console.progress("compare samplers") as progress:
        comparison = compare_samplers(
            environment, material, scene=scene, rounds=rounds, seed=seed, progress=progress
        )
    if console.as_json:
        console.print_json(
            {
                "best": comparison.best,
                "costs": comparison.costs,
                "p_values": comparison.p_values,
                "noise": comparison.noise,
                "seconds": comparison.seconds,
            }
        )
    else:
        console.print_table(COLUMNS, comparison.table(), title=comparison.head)
        console.output.print(comparison.verdict)
    if comparison.rounds < comparison.rounds_requested:
        exit_interrupted(
            f"{comparison.rounds} of {comparison.rounds_requested} rounds are finished"
        )
