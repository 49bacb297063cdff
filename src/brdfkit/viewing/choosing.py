"""Chooses the application for what a user asks to view: a volume, or a material and models."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core import catalogue
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.locate import looks_like_name
from brdfkit.model import labels
from brdfkit.viewing.application import Application
from brdfkit.viewing.empty import EmptyApplication
from brdfkit.viewing.materials.application import MaterialApplication
from brdfkit.viewing.volumes.application import VolumeApplication
from brdfkit.viewing.volumes.source import find_volume, load_within_memory
from brdfkit.volumes import Volume, made
from brdfkit.volumes.loading import looks_like_volume


def is_volume(thing: Any) -> bool:
    """Return whether something to view is a volume, or the name or path of one."""
    if isinstance(thing, str | Path):
        return looks_like_volume(str(thing))
    return isinstance(thing, Volume | np.ndarray)


def make_application(
    thing: Any,
    models: Iterable[Any] = (),
    state: Mapping[str, Any] | None = None,
    **settings: Any,
) -> Application:
    """Return the view of a volume, or of a material beside models; without a thing, an empty one.

    `settings` are other arguments of `brdfkit.volumes.load`. Raises `BrdfkitError` for what is
    neither, and for a setting of `state` that is not possible.
    """
    models = list(models)
    if thing is None:
        if state or settings:
            raise BrdfkitError("Settings belong to a volume or a material: name one.")
        return EmptyApplication()
    if is_volume(thing):
        if models:
            raise BrdfkitError(f"{thing} is a volume, which is viewed without models.")
        loaded = load_within_memory(thing, **settings) if settings else find_volume(thing)
        return VolumeApplication(*loaded, state)
    if settings:
        raise BrdfkitError(f"{thing} is no volume: --downsample and --labels are for volumes only.")
    try:
        return MaterialApplication(thing, models, state)
    except BrdfkitError:
        names = [*made.list_volume_names(), *catalogue.list_materials(), *labels.models()]
        if isinstance(thing, str) and looks_like_name(thing) and not _is_known(thing, names):
            raise no_such_error("volume, material or model", thing, names) from None
        raise


def _is_known(name: str, names: list[str]) -> bool:
    """Return whether a name means something: a known thing, a sum of models, or a file."""
    return name in names or labels.is_label(name) or Path(name).exists()
