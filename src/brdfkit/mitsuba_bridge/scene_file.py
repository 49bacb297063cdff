"""Scene files of Mitsuba's: rendered as they are, or with a material put in."""

import re
from html import unescape

from brdfkit.core.errors import BrdfkitError, nearest
from brdfkit.core.files import require_file
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.mitsuba_bridge.properties.radiance_rows import require_rows

SUFFIX = ".xml"
MAP = re.compile(r"""["']([^"'\n]+\.(?:hdr|rgbe))["']""", re.IGNORECASE)  # a Radiance file's name
PLACE = "material"  # id of the BSDF that a material replaces, where none is named


def load_scene_file(path, **how):
    """The `mitsuba.Scene` in a file; `how`: for `mitsuba.load_file`.

    Raises `BrdfkitError` for a file that is missing or that Mitsuba cannot load, and for a scene
    without a sensor or an integrator.
    """
    import mitsuba as mi

    path = require_file(path)
    _require_maps(path)

    def load(source, parallel):
        return mi.load_file(source, parallel=parallel, **how)

    scene = load_by_mitsuba(load, str(path), path)
    if not scene.sensors():
        raise BrdfkitError(f"{path}: the scene has no sensor to see it with; add a <sensor>.")
    if scene.integrator() is None:
        raise BrdfkitError(f'{path}: the scene has no integrator; add <integrator type="path"/>.')
    return scene


def make_scene_builder(source):
    """A function like those of `brdfkit.rendering.scenes`, which puts the material into a file's
    scene, in the place of one of its BSDFs.

    `source`: "FILE.xml#ID", with the id of that BSDF, or "FILE.xml", where the id is "material".
    The function returns a `mitsuba.Scene`, in the file's own size unless one is given. Raises
    `BrdfkitError` for a file that cannot be rendered, and for one without that id.
    """
    path, _, place = str(source).partition("#")
    path, place = require_file(path), place or PLACE

    def build(bsdf, size):
        # equal BSDFs would become one, with one of their ids
        scene = load_scene_file(path, optimize=False)
        by_id = {}
        for shape in scene.shapes():
            if shape.bsdf():
                by_id.setdefault(shape.bsdf().id(), []).append(shape)
        if place not in by_id:
            raise _missing_id_error(path, place, sorted(by_id))
        for shape in by_id[place]:
            shape.set_bsdf(bsdf)
        if size:
            _resize(scene.sensors()[0], size)
        return scene

    return build


def _require_maps(path):
    """Raise `BrdfkitError` for a damaged Radiance map to which a scene file refers."""
    for name in MAP.findall(path.read_text(encoding="utf-8", errors="replace")):
        file = path.parent / unescape(name)
        if file.is_file():
            require_rows(file, f"{path}: {file}")


def _missing_id_error(path, place, known):
    """The error where no shape has the BSDF that the material should replace."""
    near = nearest(place, known)
    guess = f"did you mean {path}#{near}? " if near else ""
    return BrdfkitError(
        f"{path}: no shape has a BSDF of the id {place!r}, for the material to replace; {guess}"
        f"name one as {path}#ID; there are {', '.join(known) or 'none'}."
    )


def _resize(sensor, size):
    """Give the pictures of a sensor another (width, height) [pixels]."""
    import mitsuba as mi

    parameters = mi.traverse(sensor)
    parameters["film.size"] = list(size)
    parameters.update()
