"""OSL: a shader that sums up a diffuse closure and one closure for each highlight."""

from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.exporting.filling import to_identifier, write_template
from brdfkit.exporting.ggx_sum import GgxLobe
from brdfkit.exporting.target import GGX_SUM, Held, Target, hold_ggx_sum

# Cycles rounds isotropic highlights below this width, by 1 % of the peak at 0.005. A width along y
# that differs by this share avoids it
NARROW, SHARE = 0.03, 1e-6


def write(held: Held, path: Path, comment: list[str]) -> list[Path]:
    """Write the shader, whose name is the file's."""
    write_template(
        "material.osl.jinja",
        path,
        name=to_identifier(path.stem),
        sum=held.content,
        lobes=[_to_closure(lobe) for lobe in held.content.lobes],
        comment=comment,
    )
    return [path]


def _to_closure(lobe: GgxLobe) -> dict[str, Any]:
    """Return the arguments of a highlight's closure, in which F₀ is at most 1, and its factor."""
    scale = max(1.0, *lobe.f0)
    narrow = lobe.alpha_u == lobe.alpha_v < NARROW
    return {
        "scale": scale,
        "alpha_u": lobe.alpha_u,
        "alpha_v": lobe.alpha_v * (1 + SHARE * narrow),
        "f0": np.divide(lobe.f0, scale),
        "f90": np.divide(lobe.f90, scale),
    }


TARGET = Target(
    name="osl",
    title="Open Shading Language, as Cycles has it",
    suffix=".osl",
    holds=GGX_SUM,
    hold=hold_ggx_sum,
    write=write,
)
