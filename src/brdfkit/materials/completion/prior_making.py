"""Makes a prior: of materials of brdfkit's own models, or of a folder of measured files."""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.progress_bar import Progress
from brdfkit.materials.completion.model_materials import draw_material, evaluate_parts
from brdfkit.materials.completion.prior import Prior, learn
from brdfkit.materials.completion.prior_cells import get_cells, to_logarithm

# Models lack what real materials have: this variance of the logarithm is added to what folds over
# materials leave. Without it, 95 % intervals of real materials cover 87 to 91 %
MODEL_FLOOR = 0.08**2
MODEL_MATERIALS = 1_200
SEED = 0


def make_model_prior(count: int = MODEL_MATERIALS, progress: Progress | None = None) -> Prior:
    """Make the prior that comes with brdfkit, of `count` random materials of its models."""
    rng, cells, rows = np.random.default_rng(SEED), get_cells(), []
    for k in range(count):
        values = evaluate_parts(draw_material(rng), cells.wi, cells.wo)
        rows.append(to_logarithm(values, cells.cosine))
        if progress:
            progress(k + 1, count)
    return make_prior("brdfkit's models", np.array(rows), np.arange(count), MODEL_FLOOR)


def make_prior(
    name: str, logarithms: AnyArray, groups: AnyArray, floor: float = 0.0, **details: Any
) -> Prior:
    """Make a prior of rows of logarithms (m, CELLS), which belong to the materials `groups` (m,).

    `floor` is a variance to add to the remainders of other materials, and `details` are attributes
    of the `Prior`.
    """
    reference = np.median(logarithms, axis=0)
    mean, components, remainder, new_remainder = learn(logarithms - reference, groups)
    count = len(np.unique(groups))
    return Prior(
        name, mean + reference, components, remainder, new_remainder + floor, count, **details
    )
