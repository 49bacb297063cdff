"""GLSL: the formula of the BRDF as a function of a shader, with the fitted values."""

from pathlib import Path

from brdfkit.exporting.filling import write_template
from brdfkit.exporting.target import GGX_SUM, Held, Target, hold_ggx_sum


def write(held: Held, path: Path, comment: list[str]) -> list[Path]:
    """Write the file."""
    write_template("ggx_sum.glsl.jinja", path, sum=held.content, comment=comment)
    return [path]


TARGET = Target(
    name="glsl",
    title="A function of a shader (GLSL ES 3.00, desktop GLSL)",
    suffix=".glsl",
    holds=GGX_SUM,
    hold=hold_ggx_sum,
    write=write,
)
