"""Finds the prior to use: the one that comes with brdfkit, a user's file, or a `Prior`."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TypeAlias

from brdfkit.core.catalogue import PRIORS, find_data_folder
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.completion.prior import Prior
from brdfkit.materials.completion.prior_file import read_prior

PriorLike: TypeAlias = Prior | str | Path | None


def to_prior(prior: PriorLike) -> Prior:
    """Return the `Prior` that a user gave, or the default one for None."""
    if prior is None:
        return get_default_prior()
    if isinstance(prior, Prior):
        return prior
    if not isinstance(prior, str | Path):
        raise BrdfkitError(
            f"prior = {prior!r:.60} should be a Prior, or a file that brdfkit prior wrote."
        )
    return read_prior(Path(prior))


@cache
def get_default_prior() -> Prior:
    """Return the prior that comes with brdfkit, made of random models."""
    return read_prior(find_data_folder(PRIORS) / "models.npz")
