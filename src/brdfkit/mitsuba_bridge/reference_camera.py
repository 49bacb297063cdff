"""The cameras of the small scenes with known radiance by which plugins are checked."""


def reference_film(size=8):
    """The dictionary of a square film of independent pixels, in colours if there are any."""
    import mitsuba as mi

    pixels = "luminance" if mi.is_monochromatic else "rgb"
    edges = {"width": size, "height": size, "rfilter": {"type": "box"}}
    return {"type": "hdrfilm", "pixel_format": pixels, **edges}


def through_unit_cube():
    """The dictionary of a camera whose rays all go through the unit cube, along -z."""
    import mitsuba as mi

    to_world = mi.ScalarTransform4f().look_at([0.5, 0.5, 3], [0.5, 0.5, 0], [0, 1, 0]).scale(0.4)
    return {"type": "orthographic", "to_world": to_world, "film": reference_film()}
