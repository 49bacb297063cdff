"""Losses as textbooks have them: sums over the samples, each of which counts as one."""

from dataclasses import replace

from brdfkit.regression import losses


def sample_sum(name):
    """The loss of this name as such a sum."""
    return replace(losses.named.by_sample[name], name=f"{name} sum", measure="samples")
