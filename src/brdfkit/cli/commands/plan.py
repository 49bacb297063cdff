"""`brdfkit plan`: chooses the directions that are worth measuring."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.options import output_option, prior_option, writing_options
from brdfkit.core.errors import BrdfkitError

ANGLE: dict[str, Any] = {"type": float, "metavar": "DEGREES"}


@click.command()
@click.argument("n", type=int, metavar="N")
@click.option(
    "--max-theta-i", help="Largest angle of the light to the normal. Default: 75.", **ANGLE
)
@click.option(
    "--max-theta-o", help="Largest angle of the detector to the normal. Default: 75.", **ANGLE
)
@click.option(
    "--separation",
    help="Least angle between light and detector, at which one does not shade the other. "
    "Default: 5.",
    **ANGLE,
)
@click.option("--step", help="Step of the instrument's arms. Default: 0.5.", **ANGLE)
@click.option("--in-plane", is_flag=True, help="The arms stay in one plane.")
@click.option(
    "--theta-i", metavar="DEGREES,...", help="The angles of a light that has only a few places."
)
@click.option(
    "--measured", metavar="FILE", help="Values that are measured already: plan further ones."
)
@prior_option
@click.option(
    "--noise",
    type=float,
    default=0.05,
    metavar="SHARE",
    show_default=True,
    help="Relative standard deviation of a value.",
)
@click.option(
    "--alignment",
    default=0.0,
    show_default=True,
    help="Angle by which directions may be off.",
    **ANGLE,
)
@click.option(
    "--channels",
    default="R,G,B",
    metavar="NAME,...",
    show_default=True,
    help="Columns of values in the .csv: R,G,B, or BRDF, or wavelengths such as 450nm,550nm.",
)
@click.option(
    "--seed",
    default=0,
    type=click.IntRange(min=0),
    metavar="N",
    show_default=True,
    help="Seed of the directions to choose from.",
)
@output_option(
    "File to write: .csv, a table with empty fields for the values; or a picture, .png, .pdf or "
    ".svg. Default: nothing is written."
)
@writing_options
def plan(
    n: int,
    theta_i: str | None,
    in_plane: bool,
    channels: str,
    output: Path | None,
    console: Console,
    **options: Any,
) -> None:
    """Choose N directions worth measuring.

    The command lists pairs of directions of light and detector in the order of their gain, with the
    error that is to be expected of the completed material after each. Fill the measured values into
    the .csv file, and give it to brdfkit complete.
    """
    from brdfkit.core.files import require_writable
    from brdfkit.materials.completion.plan import plan as choose
    from brdfkit.materials.completion.plan_output import check_channels

    names = check_channels([name.strip() for name in channels.split(",")])
    if output:
        require_writable(output)
    limits = ("max_theta_i", "max_theta_o", "separation", "step")
    entries: Any = {name: options.pop(name) for name in limits}
    entries |= {"in_plane": in_plane or None, "theta_i": _parse_angles(theta_i)}
    reach: Any = {name: value for name, value in entries.items() if value is not None}
    with console.progress(f"plan {n}"):
        chosen = choose(n, reach=reach, **options)
        if output:
            chosen.save(output, names)
    written = [output] if output else []
    if console.as_json:
        record = {"angles": chosen.angles, "errors": chosen.errors, "halves": chosen.halves}
        console.print_json({**record, "info": chosen.info, "written": written})
        return
    console.output.print(str(chosen))
    console.print_written(written)


def _parse_angles(text: str | None) -> list[float] | None:
    """Return the angles in a text with commas; None stays None."""
    try:
        return [float(part) for part in text.split(",")] if text else None
    except ValueError:
        raise BrdfkitError(f"The angles {text!r} should read DEGREES,DEGREES,...") from None
