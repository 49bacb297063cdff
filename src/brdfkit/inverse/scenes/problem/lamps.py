"""Switches the lamps of a scene, so that only those burn that burned in a photograph.

A lamp that is off has the strength 0, and the weight 0 where a sample chooses a lamp to ask for
light. A picture under one of many lamps is therefore as quiet, and takes as long, as in a scene
with this lamp alone. Strengths are no constants of the kernels, so that all pictures share one.

In this file `parameters` is always the object that `mitsuba.traverse` returns.
"""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass
from typing import Any, TypeAlias

import drjit as dr

from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.inverse.scenes.problem.by_picture import arrange_by_picture

Names: TypeAlias = str | Iterable[str]
Lights: TypeAlias = Mapping[str, Names] | Iterable[Names]

# Parameters of emitters that hold their strength; of several, the first ones count
STRENGTHS = ("scale",), ("sun_scale", "sky_scale"), ("radiance",), ("intensity",), ("irradiance",)
# Mitsuba chooses lamps by another kernel if all weights are 1; so those that burn have this share
BURNING_WEIGHT = 0.5


@dataclass(frozen=True)
class Lamp:
    """An emitter that can be switched off.

    name : the emitter's name in `mitsuba.traverse`, such as "lamp.emitter".
    strengths : the values at the start of the entries that hold its strength, by key.
    weights : its weight in the choice of lamps, by key; empty for an emitter without it.
    """

    name: str
    strengths: dict[str, MitsubaObject]
    weights: dict[str, float]


class Lighting:
    """The lamps of a scene, and which of them burn in which picture.

    lamps : all lamps of the scene.
    burning : the names of the lamps that burn in each picture.
    unused : the names of the lamps that burn in no picture.
    """

    def __init__(
        self, parameters: MitsubaObject, lights: Lights, pictures: tuple[str, ...]
    ) -> None:
        self.parameters = parameters
        keys = find_lamp_keys(parameters)
        self.lamps = [_make_lamp(parameters, name, own) for name, own in keys.items()]
        self.burning = [
            _choose_lamps(names, picture, list(keys))
            for names, picture in zip(
                arrange_by_picture("lights", "list of lamps", lights, pictures),
                pictures,
                strict=True,
            )
        ]
        used = frozenset().union(*self.burning)
        self.unused = tuple(shorten_lamp(name) for name in keys if name not in used)
        # What was written last of each lamp; several `Lighting`s of one scene share it
        self._last: dict[str, bool | None] = {}

    def pick_pictures(self, numbers: Iterable[int]) -> "Lighting":
        """Return the same lamps for some of the pictures, by their numbers."""
        some = copy(self)
        some.burning = [self.burning[i] for i in numbers]
        return some

    def find_pictures_lit_by(self, key: str) -> list[int] | None:
        """Return the numbers of the pictures in which the lamp burns that the entry `key` is of.

        Returns None if the entry belongs to no lamp, so that it may change all pictures.
        """
        for lamp in self.lamps:
            if key.startswith(f"{lamp.name}."):
                return [i for i, names in enumerate(self.burning) if lamp.name in names]
        return None

    def switch(self, picture: int | None, searched: Mapping[str, MitsubaObject]) -> None:
        """Write the strengths and weights of all lamps for a picture; for None, all of them burn.

        `searched` holds the values of entries that are searched, by key. Their derivatives reach
        the strengths of the lamps that burn, and are 0 for the others.
        """
        import mitsuba as mi

        for lamp in self.lamps:
            burns = None if picture is None else lamp.name in self.burning[picture]
            own = lamp.strengths | {k: searched[k] for k in lamp.strengths if k in searched}
            is_same = lamp.name in self._last and self._last[lamp.name] == burns
            if is_same and lamp.strengths.keys().isdisjoint(searched):
                continue
            share = dr.opaque(mi.Float, float(burns is not False))
            for key, value in own.items():
                self.parameters[key] = value if burns is None else _scale(value, share)
            for key, weight in lamp.weights.items():
                self.parameters[key] = weight * (1 if burns is None else BURNING_WEIGHT * burns)
            self._last[lamp.name] = burns

    @contextmanager
    def restored_after_errors(self) -> Iterator[None]:
        """Run a block; after an error in it all lamps burn again, at their strengths of before."""
        try:
            yield
        except BaseException:
            self._last.clear()
            self.switch(None, {})
            self.parameters.update()
            raise


def find_lamp_keys(parameters: MitsubaObject) -> dict[str, list[str]]:
    """Return the keys of the entries that belong to each emitter, by the emitter's name."""
    import mitsuba as mi

    lamps: dict[str, list[str]] = {}
    for key, (_, _, owner, _) in parameters.properties.items():
        name = key.rpartition(".")[0]
        while owner is not None and not isinstance(owner, mi.Emitter):
            owner, name = parameters.hierarchy[owner][0], name.rpartition(".")[0]
        if owner is not None:
            lamps.setdefault(name, []).append(key)
    return lamps


def shorten_lamp(name: str) -> str:
    """Return a lamp's name as users write it: that of its shape, for the emitter of a shape."""
    return name.removesuffix(".emitter")


def _make_lamp(parameters: MitsubaObject, name: str, keys: list[str]) -> Lamp:
    """Return the `Lamp` of the emitter `name`, to which the entries `keys` belong."""
    paths = {key: key.removeprefix(f"{name}.").split(".") for key in keys}
    for group in STRENGTHS:
        own = [
            key
            for key, path in paths.items()
            if path[0] in group and (len(path) == 1 or path[-1] in ("value", "data"))
        ]
        if own:
            break
    else:
        raise BrdfkitError(
            f"lights: {shorten_lamp(name)} has no strength that could be switched off; leave it "
            "out of the scene, or leave lights out."
        )
    weights = [key for key, path in paths.items() if path == ["sampling_weight"]]
    return Lamp(
        name,
        {key: type(parameters[key])(parameters[key]) for key in own},
        {key: float(parameters[key]) for key in weights},
    )


def _choose_lamps(names: Any, picture: str, known: list[str]) -> frozenset[str]:
    """Return the names in `mitsuba.traverse` of the lamps that users name for a picture."""
    chosen: set[str] = set()
    for name in [names] if isinstance(names, str) else names or ():
        own = [one for one in known if one == name or one.startswith(f"{name}.")]
        if not own:
            raise no_such_error("lamp", name, map(shorten_lamp, known), f"lights: {picture}")
        chosen.update(own)
    if not chosen:
        raise BrdfkitError(
            f"lights: no lamp burns in {picture}; name those that did, of "
            f"{', '.join(map(shorten_lamp, known)) or 'none'}."
        )
    return frozenset(chosen)


def _scale(value: Any, share: MitsubaObject) -> Any:
    """Return a strength times a share, in its own type; Python's numbers need no Dr.Jit array."""
    return value * share[0] if isinstance(value, float) else type(value)(value * share)
