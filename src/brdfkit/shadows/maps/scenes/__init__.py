"""Scenes on which shadow techniques are compared, made anew from seeds; one file is one scene.

A file NAME.py holds the function `NAME(view="V1", light=1, size=(512, 512))`, the dictionary of
the scene for `mitsuba.load_dict`: four views, V1 to V4, and two suns that are close together, 1 and
2, as [Ergun 2008, 4.2] has them. See `_stage.py`, which all share. The sun is the only light, as
shadow maps need it; for pretty pictures give the dictionary a "sky".
"""

from brdfkit.core.discovery.plugin_files import import_modules
from brdfkit.shadows.maps.scenes._stage import LIGHTS, VIEWS

SCENES = {
    module.__name__.rpartition(".")[2]: getattr(module, module.__name__.rpartition(".")[2])
    for module in import_modules(__name__, __path__)
}


def in_all_views(name, size=(512, 512)):
    """The scene of a `name` with all its cameras, V1 to V4, and both suns, sun_1 and sun_2.

    >>> sorted(in_all_views("street"))[:4]
    ['V1', 'V2', 'V3', 'V4']
    """
    build = SCENES[name]
    found = build(size=size)
    del found["camera"], found["sun"]
    cameras = {view: build(view, size=size)["camera"] for view in VIEWS}
    suns = {f"sun_{light}": build(light=light)["sun"] for light in LIGHTS}
    return found | cameras | suns


__all__ = ["LIGHTS", "SCENES", "VIEWS", "in_all_views"]
