"""The scenes that pictures show: each file in this folder is one scene, and is found by its name.

A file NAME.py contains the function `NAME(bsdf, size=(512, 512))`, which returns the scene's
dictionary for `mitsuba.load_dict`:

- `bsdf`: the BSDF, a dictionary or an object, of the shape that shows the material;
- `size`: (width, height) of the picture [pixels];
- the first line of the file's docstring describes the picture;
- the keys of the lights are "sky" and "softbox" if an environment map may replace them.

The function works in every variant of Mitsuba. The exposure is such that a white wall paint nearly
reaches the largest value of sRGB, so pictures of different materials and scenes can be compared. A
file whose name begins with an underscore is no scene, but contains parts that scenes share.
"""

import importlib
from collections.abc import Callable
from typing import Any

from brdfkit.core.discovery.plugin_files import find_module_names
from brdfkit.core.errors import no_such_error


def scene_names() -> list[str]:
    """Return the names of the scenes, in alphabetical order.

    >>> "ball" in scene_names()
    True
    """
    return list(find_module_names(__path__))


def find_scene(name: str) -> Callable[..., dict[str, Any]]:
    """Return the function that makes the scene `name`; raise `BrdfkitError` for an unknown name.

    >>> find_scene("ball")({"type": "diffuse"})["type"]
    'scene'
    """
    if name not in scene_names():
        raise no_such_error("scene", name, scene_names())
    return getattr(importlib.import_module(f"{__name__}.{name}"), name)
