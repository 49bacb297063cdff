"""Assigns names, cameras and other things to the pictures that `refine` has to match."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeAlias

from brdfkit.core.array_types import FloatArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError, no_such_error

Picture: TypeAlias = FloatArray | str | Path
Pictures: TypeAlias = Picture | Iterable[Picture] | Mapping[str, Picture]
Cameras: TypeAlias = Mapping[str, str] | Iterable[str]


def name_pictures(pictures: Any) -> dict[str, Any]:
    """Return the pictures by name: as a user named them, else by their numbers, from "0" on."""
    if isinstance(pictures, Mapping):
        named = {str(name): picture for name, picture in pictures.items()}
    else:
        alone = isinstance(pictures, str | Path) or getattr(pictures, "ndim", 4) < 4
        several = [pictures] if alone else list(pictures)
        named = {str(number): picture for number, picture in enumerate(several)}
    if not named:
        raise BrdfkitError("there is no picture to match; give one for each sensor.")
    return named


def arrange_by_picture(argument: str, thing: str, values: Any, names: tuple[str, ...]) -> list[Any]:
    """Return one of the `values` for each of the pictures `names`, None where there is none.

    `values` is a mapping by the names of pictures, or a sequence in the order of the pictures. In
    errors they are the `argument` of `refine` that holds a `thing` for each picture.
    """
    if isinstance(values, Mapping):
        for name in values:
            if str(name) not in names:
                raise no_such_error("picture", name, names, argument)
        by_name = {str(name): value for name, value in values.items()}
        return [by_name.get(name) for name in names]
    several = [values] if isinstance(values, str) else list(values)
    if len(several) != len(names):
        raise BrdfkitError(
            f"{argument}: there should be one {thing} for each picture: {len(several)} for "
            f"{len(names)}."
        )
    return several


def choose_sensors(
    scene: MitsubaObject, names: tuple[str, ...], cameras: Cameras | None, is_lit_apart: bool
) -> list[MitsubaObject]:
    """Return the sensor that took each of the pictures `names`.

    That is the one that `cameras` names; else the only one of the scene, if pictures differ by
    their lamps (`is_lit_apart`); else the one with the picture's name as its id; else the sensors
    in their order. Raises `BrdfkitError` for unknown ids, and where a picture has no camera.
    """
    sensors = scene.sensors()
    by_id = {sensor.id(): sensor for sensor in sensors}
    if cameras is None:
        if len(sensors) == 1 and is_lit_apart:
            return sensors * len(names)
        if all(name in by_id for name in names):
            return [by_id[name] for name in names]
        if len(sensors) != len(names):
            ids = ", ".join(by_id)
            mend = (
                f"name the camera of each in cameras, of {ids}"
                if is_lit_apart
                else "or name in lights the lamps that burned in each"
            )
            raise BrdfkitError(
                f"there should be one picture for each sensor: {len(names)} for {len(sensors)}; "
                f"{mend}."
            )
        return list(sensors)
    chosen = arrange_by_picture("cameras", "camera", cameras, names)
    for picture, name in zip(names, chosen, strict=True):
        if name not in by_id:
            raise no_such_error("camera", name or "", by_id, f"cameras: {picture}")
    return [by_id[name] for name in chosen]
