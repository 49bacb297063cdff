"""The one eye from which the faces of volumes are counted."""

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.camera import Camera


def pinhole(sensor):
    """The `Camera` of one of Mitsuba's sensors; `BrdfkitError` for one with a lens."""
    import mitsuba as mi

    if "aperture_radius" in mi.traverse(sensor):
        raise BrdfkitError(
            "shadow volumes are counted along rays from one eye, and a thinlens camera has a whole "
            "lens; use a perspective camera."
        )
    return Camera.of_sensor(sensor)
