"""Scenes on which shadow techniques are compared, made anew from seeds; one file is one scene.

A file NAME.py holds the function `NAME(view="V1", light=1, size=(512, 512))`, the dictionary of
the scene for `mitsuba.load_dict`: four views, V1 to V4, and two suns that are close together, 1 and
2, as [Ergun 2008, 4.2] has them. See `_stage.py`, which all share. The sun is the only light, as
shadow maps need it; for pretty pictures give the dictionary a "sky".
"""

from brdfkit.modules import modules_in
from brdfkit.shadow_maps.scenes._stage import LIGHTS, VIEWS

SCENES = {
    module.__name__.rpartition(".")[2]: getattr(module, module.__name__.rpartition(".")[2])
    for module in modules_in(__name__, __path__)
}

__all__ = ["LIGHTS", "SCENES", "VIEWS"]
