"""The scenes that pictures show: each file of this folder is one scene and is found by its name.

A file NAME.py holds the function `NAME(bsdf, size=(512, 512))`, the dictionary of the scene for
`mitsuba.load_dict`:

- `bsdf`: the material, a BSDF as a dictionary or an object, for whatever is to show it;
- `size`: (width, height) of the picture [pixels];
- the first line of the file's docstring says what the picture shows;
- the light has the keys "sky" and "softbox" where an environment map may take its place.

It works in every variant of Mitsuba, and is exposed so that a white wall paint nearly fills the
range of sRGB: then pictures of different materials, and of different scenes, can be compared. A
file whose name begins with an underscore is no scene: it holds what several scenes share.
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
