"""Makes the `Views` that a search works on from the arguments of `refine`."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.scenes.problem.by_picture import Cameras, choose_sensors
from brdfkit.inverse.scenes.problem.lamps import Lighting, Lights
from brdfkit.inverse.scenes.problem.parameters import PARAMETER_LIMIT, choose_unknowns
from brdfkit.inverse.scenes.problem.scene import load_scene, make_integrator
from brdfkit.inverse.scenes.problem.targets import Target
from brdfkit.inverse.scenes.problem.views import Views


def make_views(
    scene: Any,
    targets: list[Target],
    parameters: Iterable[str] | Mapping[str, tuple[float, float] | None] | None,
    lights: Lights | None,
    cameras: Cameras | None,
) -> Views:
    """Return the scene, its searched parameters and its target pictures as `Views`."""
    import mitsuba as mi

    loaded = load_scene(scene, targets[0].size)
    traversed, names = mi.traverse(loaded), tuple(target.name for target in targets)
    lighting = None if lights is None else Lighting(traversed, lights, names)
    sensors = choose_sensors(loaded, names, cameras, lighting is not None)
    unknowns = choose_unknowns(traversed, parameters)
    numbers = sum(len(unknown.start) for unknown in unknowns)
    values = sum(np.count_nonzero(target.weights) for target in targets)
    if not values or values < numbers <= PARAMETER_LIMIT:
        raise BrdfkitError(
            f"refine: {numbers} number{'s are' if numbers > 1 else ' is'} more than the {values} "
            "values of the pictures that count, as they are neither masked nor clipped; give "
            "larger or darker pictures, or name fewer."
        )
    integrator = make_integrator(loaded)
    return Views(loaded, integrator, targets, traversed, unknowns, sensors, lighting)
