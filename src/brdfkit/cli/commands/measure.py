"""`brdfkit measure`: measures the BRDF of microgeometry in a virtual goniometer."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import click

from brdfkit.cli.commands.info import print_audit
from brdfkit.cli.console import Console
from brdfkit.cli.errors import exit_interrupted
from brdfkit.cli.options import output_option, writing_options
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_writable


@click.command()
@click.argument("geometry", metavar="gaussian|brushed|woven")
@click.option(
    "--slope", default=0.3, show_default=True, help="Root-mean-square slope of the surface."
)
@click.option("--stretch", type=float, help="For brushed: length of a groove over its width.")
@click.option("--thickness", type=float, help="For woven: thickness of a yarn over its width.")
@click.option(
    "--facets",
    multiple=True,
    default=["Au"],
    show_default=True,
    metavar="MATERIAL",
    help="Material of the facets: a metal (Au, Al, Cu ...), paint:R,G,B or plastic:R,G,B; give it "
    "twice for warp and weft.",
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
    help="Cells of the table in theta_h, theta_d and phi_d; for brushed and woven, with phi_h "
    "before them.",
)
@click.option("--error", default=0.05, show_default=True, help="Relative standard error to reach.")
@click.option(
    "--spp",
    default=16384,
    show_default=True,
    metavar="N",
    help="Largest number of samples per cell.",
)
@click.option("--seed", default=0, show_default=True, metavar="N", help="Seed of the samples.")
@output_option("File to write, .npz. Default: GEOMETRY.npz.")
@writing_options
def measure(
    geometry: str,
    facets: tuple[str, ...],
    facet_alpha: float,
    specimen: int,
    shape: str | None,
    error: float,
    spp: int,
    seed: int,
    output: Path | None,
    console: Console,
    **relief: float | None,
) -> None:
    """Measure the BRDF of microgeometry.

    A virtual goniometer traces paths over a surface that is rough (gaussian), grooved (brushed) or
    cloth (woven). It writes a table with a standard error for every value. The defaults measure
    rough gold, in about a minute. Ctrl-C ends the measurement early, with larger errors.
    """
    from brdfkit.materials.auditing import audit
    from brdfkit.materials.goniometer import measure as measure_surface
    from brdfkit.materials.goniometer import microgeometry
    from brdfkit.materials.loading import save

    path = _check_table_path(output or Path(f"{geometry}.npz"))
    given = {name: value for name, value in relief.items() if value is not None}
    surface = microgeometry.make_height_field(geometry, **given, seed=specimen)
    bsdfs, cells = _make_bsdfs(facets, facet_alpha), _parse_shape(shape)
    context = click.get_current_context()
    with console.progress(f"measure {geometry}") as progress:
        measured = measure_surface(
            surface,
            bsdfs,
            shape=cells,
            error=error,
            spp=spp,
            name=path.stem,
            info={"command": _format_command(context.params)},
            seed=seed,
            progress=progress,
        )
    save(measured, path)
    with console.progress("audit"):
        result = audit(measured)
    print_audit(result, [path], console)
    if "interrupted" in measured.info:
        exit_interrupted(f"measured with {measured.info['interrupted']}")


def _make_bsdfs(words: Sequence[str], alpha: float) -> list[dict[str, Any]]:
    """Return Mitsuba's dictionary of a BSDF for each word METAL, paint:R,G,B or plastic:R,G,B.

    >>> _make_bsdfs(["paint:0.8,0.7,0.6"], alpha=0.2)[0]["type"]
    'diffuse'
    """
    if not 0.01 <= alpha <= 1:
        raise BrdfkitError(f"facet-alpha = {alpha:g} is out of bounds; give one from 0.01 to 1.")
    return [_make_bsdf(word, alpha) for word in words]


def _make_bsdf(word: str, alpha: float) -> dict[str, Any]:
    """Return the dictionary of a BSDF for one word, with the GGX roughness `alpha`."""
    kind, colon, colour = word.partition(":")
    rough = {"distribution": "ggx", "alpha": alpha}
    if not colon:
        return {"type": "roughconductor", "material": kind, **rough}
    message = f"The facets {word!r} should read METAL, or paint:R,G,B or plastic:R,G,B from 0 to 1."
    rgb = _parse_numbers(colour, float, message)
    if len(rgb) != 3 or not all(0 <= value <= 1 for value in rgb):
        raise BrdfkitError(message)
    reflectance = {"type": "rgb", "value": rgb}
    if kind == "paint":
        return {"type": "diffuse", "reflectance": reflectance}
    if kind == "plastic":
        return {"type": "roughplastic", "diffuse_reflectance": reflectance, **rough}
    raise BrdfkitError(message)


def _parse_shape(text: str | None) -> list[Any] | None:
    """Return the shape of a table from the text N,N,N or N,N,N,N; None stays None."""
    message = f"The shape {text!r} should read N,N,N or N,N,N,N."
    return _parse_numbers(text, int, message) if text else None


def _parse_numbers(text: str, kind: Callable[[str], Any], message: str) -> list[Any]:
    """Return the numbers in a text with commas, or raise `BrdfkitError` with the `message`."""
    try:
        return [kind(part) for part in text.split(",")]
    except ValueError as error:
        raise BrdfkitError(message) from error


def _format_command(parameters: Mapping[str, Any]) -> str:
    """Return a command line with all `parameters` that determine the measurement."""
    words = ["brdfkit", "measure", parameters["geometry"]]
    for name, value in parameters.items():
        if name not in ("geometry", "output", "force", "as_json", "quiet") and value is not None:
            for single in value if isinstance(value, tuple) else (value,):
                words += [f"--{name.replace('_', '-')}", str(single)]
    return shlex.join(words)


def _check_table_path(path: Path) -> Path:
    """Check that `path` can be written and that its format holds standard errors; return it."""
    if path.suffix.lower() != ".npz":
        raise BrdfkitError(
            f"{path}: a measurement is written as .npz; name such a file, and convert it later."
        )
    require_writable(path)
    return path
