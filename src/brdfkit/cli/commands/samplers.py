"""`brdfkit samplers`: which sampler of an environment map suits it, on a material and a mesh."""

import click

from brdfkit.cli.errors import say
from brdfkit.cli.options import MESHES, output_options
from brdfkit.core.interrupts import exit_status


@click.command()
@click.argument("environment", metavar="NAME|MAP")
@click.option(
    "--material",
    default="plaster",
    show_default=True,
    metavar="NAME|FILE",
    help="What is lit: a material, a fit or a model.",
)
@click.option(
    "--scene",
    default="ball",
    show_default=True,
    metavar="SCENE",
    help=f"A scene under the sky, as of render; or {MESHES}, FILE.obj#z where its axis z is up.",
)
@click.option(
    "--rounds",
    type=click.IntRange(min=3),
    default=10,
    show_default=True,
    metavar="N",
    help="Repeats; more of them tell smaller differences from chance.",
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, metavar="N")
@output_options
def samplers(environment, material, scene, rounds, seed, console):
    """Find the sampler that suits an environment map.

    Each sampler path-traces the same pictures; what counts is noise × time: what an equally good
    picture costs. The table says whether a difference to the best is more than chance (Tukey's
    test, 5 % for all samplers together). Times are of the processor, and a busy machine still
    blurs them: other work should rest. Compensated samplers suit path tracing only, which samples
    surfaces as well. Ctrl-C keeps the finished rounds.
    """
    from brdfkit.rendering.map_sampling import COLUMNS, compare_samplers

    with console.progress("compare samplers") as progress:
        found = compare_samplers(
            environment, material, scene=scene, rounds=rounds, seed=seed, progress=progress
        )
    if console.as_json:
        console.json(
            {
                "best": found.best,
                "costs": found.costs,
                "p_values": found.p_values,
                "noise": found.noise,
                "seconds": found.seconds,
            }
        )
    else:
        console.table(COLUMNS, found.table(), title=found.head)
        console.out.print(found.verdict)
    if found.rounds < found.rounds_requested:
        say(f"interrupted; {found.rounds} of {found.rounds_requested} rounds are finished.")
        click.get_current_context().exit(exit_status())
