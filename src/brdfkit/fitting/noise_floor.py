"""The noise floor of a measurement: the errors of a perfect model, which its noise leaves."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from brdfkit.fitting.compare import compute_error
from brdfkit.materials.auditing.noise import estimate_noise
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.selection import select_samples
from brdfkit.regression import losses


def compute_noise_floor(
    data: Measured, names: Iterable[str], max_angle: float = 80.0, seed: int = 0
) -> dict[str, float]:
    """Return the error under each named loss that the noise of a measurement alone causes.

    The measured values are compared with themselves, changed by noise of the relative standard
    deviation that `estimate_noise` finds. The result is empty if it finds none.
    """
    rgb = data.rgb
    relative = np.array(estimate_noise(rgb).relative)
    if not np.isfinite(relative).all():
        return {}
    samples = select_samples(data, max_angle)
    noise = relative * np.random.default_rng(seed).standard_normal(samples.values.shape)
    values = samples.values * (1 + noise)
    return {name: compute_error(losses.named.by_sample[name], values, samples) for name in names}
