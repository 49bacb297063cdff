"""Scenes on which shadow techniques are compared, made from fixed random seeds; one file each.

A file NAME.py has the function `NAME(view="V1", light=1, size=(512, 512))`, which returns the
scene's dictionary for `mitsuba.load_dict`. `view` is one of four views, V1 to V4, and `light` one
of two suns that are close together, 1 and 2, as in [Ergun 2008, 4.2]. All scenes share the views
and suns, see `_stage.py`. The sun is the only light, as shadow maps need it; for pretty pictures
add a "sky" to the dictionary.
"""

from collections.abc import Callable
from typing import Any

from brdfkit.core.discovery.plugin_files import import_modules
from brdfkit.shadows.maps.scenes._stage import LIGHTS, VIEWS

SCENES: dict[str, Callable[..., dict[str, Any]]] = {
    module.__name__.rpartition(".")[2]: getattr(module, module.__name__.rpartition(".")[2])
    for module in import_modules(__name__, __path__)
}


def make_scene_in_all_views(name: str, size: tuple[int, int] = (512, 512)) -> dict[str, Any]:
    """Return the named scene's dictionary with all cameras, V1 to V4, and suns, sun_1 and sun_2.

    >>> sorted(make_scene_in_all_views("street"))[:4]
    ['V1', 'V2', 'V3', 'V4']
    """
    build = SCENES[name]
    scene = build(size=size)
    del scene["camera"], scene["sun"]
    cameras = {view: build(view, size=size)["camera"] for view in VIEWS}
    suns = {f"sun_{light}": build(light=light)["sun"] for light in LIGHTS}
    return scene | cameras | suns


__all__ = ["LIGHTS", "SCENES", "VIEWS", "make_scene_in_all_views"]
