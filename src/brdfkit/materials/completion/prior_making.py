"""Makes a prior of rows of logarithms, and the one of models that comes with brdfkit."""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.progress_bar import Progress
from brdfkit.materials.completion.model_materials import draw_material
from brdfkit.materials.completion.prior import BASE_SHARE, Prior, learn
from brdfkit.materials.completion.prior_cells import CELLS, get_cells, to_logarithm

# Models lack what real materials have, so variances are added to what folds over them leave: a
# constant one, and a share of the variance among materials, which is large in highlights. Without
# them, 95 % intervals of real materials cover 87 to 91 %
MODEL_FLOOR, MODEL_SHARE = 0.06**2, 0.05**2
# Models differ from real materials most where a direction is this near to the horizon
GRAZING, GRAZING_FLOOR = np.radians(80.0), 0.3**2
# Cells without directions of their own repeat a value, of which they may differ by this variance
REPEATED = 0.7**2
MODEL_MATERIALS = 2_400
SEED = 0


def make_model_prior(count: int = MODEL_MATERIALS, progress: Progress | None = None) -> Prior:
    """Make the prior that comes with brdfkit, of `count` random materials of models."""
    rows = np.empty((count, CELLS), np.float32)
    for k in range(count):
        rows[k] = draw_row(k)
        if progress:
            progress(k + 1, count)
    cells = get_cells()
    grazing = np.maximum(cells.theta_i, cells.theta_o) > GRAZING
    floor = MODEL_FLOOR + GRAZING_FLOOR * grazing
    return make_prior("brdfkit's models", rows, np.arange(count), floor=floor, share=MODEL_SHARE)


def draw_row(number: int) -> AnyArray:
    """Return the logarithms (CELLS,) of the random material of this number."""
    return to_logarithm(draw_material(np.random.default_rng([SEED, number])), get_cells().cosine)


def make_prior(
    name: str,
    logarithms: AnyArray,
    groups: AnyArray,
    *,
    floor: AnyArray | float = 0.0,
    share: float = 0.0,
    base: Prior | None = None,
    **details: Any,
) -> Prior:
    """Make a prior of rows of logarithms (m, CELLS), which belong to the materials `groups` (m,).

    `floor` is a variance, or one for each cell, that is added to the remainders of other materials,
    and `share` that part of the variance among materials. The materials of a `base` count as well,
    by `BASE_SHARE`. `details` are attributes of the `Prior`.
    """
    arrays = [array.astype(float) for array in learn(logarithms, groups, base)]
    mean, components, remainder, new_remainder = arrays
    repeated = REPEATED * ~get_cells().own * (1.0 if base is None else 1 - BASE_SHARE)
    new_remainder = new_remainder + floor + share * np.sum(components**2, axis=1) + repeated
    count = len(np.unique(groups))
    return Prior(name, mean, components, remainder, new_remainder, count, **details)
