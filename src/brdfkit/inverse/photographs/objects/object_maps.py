"""Defines `ObjectMaps`, the result of `svbrdf` for photographs of an object."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_array, wrong_value_error
from brdfkit.core.array_types import ArrayLike, BoolArray, FloatArray
from brdfkit.core.documents import Document, Shown
from brdfkit.core.jit.threads import in_turn
from brdfkit.inverse.photographs.capture.lights import Lights, to_strength
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.objects.fit_object import FittedObject
from brdfkit.inverse.photographs.objects.summary import describe_object
from brdfkit.inverse.photographs.result.comparison import Comparison


@dataclass(frozen=True, eq=False, repr=False)
class ObjectMaps(Shown):
    """Maps of an object, in the pixels of its photographs: normals, and a model's weights.

    Pixels outside of the object are 0 in all maps, and their normals point to the camera.

    Attributes
    ----------
    name : str
        The object's name.
    model : str
        Label of the model.
    maps : dict of str to ndarray
        The weight of each lobe, (height, width, 3) in linear sRGB, and ``"normal"``, unit vectors
        (height, width, 3): x to the right, y up, z towards the camera.
    fixed : dict of str to float
        The model's shape parameters, with one value everywhere, found or given.
    mask : ndarray of bool, shape (height, width)
        Which pixels show the object.
    uncertainty : dict of str to ndarray
        The standard error (height, width) of each map, that of the normal in radians, for the noise
        of the photographs. Empty where Ctrl-C ended the search.
    lights : ndarray, shape (height, width)
        How many photographs tell something of a pixel: in the others it is in the shadow or
        clipped. Photographs with large residuals count in part.
    exposures : dict of str to float
        The factor of the stated light in each photograph, which the fit found.
    noise : float
        The standard deviation of the relative residuals.
    fitted_errors : Comparison, or None
        The errors of the fitted photographs.
    held_out_errors : Comparison, or None
        The errors of photographs that were held out.
    lambertian_errors : Comparison, or None
        The errors of the photographs held out if predicted by Lambertian photometric stereo.
    normal_error, lambertian_normal_error : float, or None
        The mean angle to the true normals [degrees], where these are known.
    notes : tuple of str
        Sentences about doubtful findings.
    seconds : float
        Wall-clock time.
    capture : ObjectCapture
        The photographs that were fitted.
    held_out_capture : ObjectCapture, or None
        The photographs that were held out.
    state : FittedObject
        The state of the search: the fitted pixels, and what they share.
    """

    name: str
    model: str
    maps: dict[str, FloatArray]
    fixed: dict[str, float]
    mask: BoolArray
    uncertainty: dict[str, FloatArray]
    lights: FloatArray
    exposures: dict[str, float]
    noise: float
    fitted_errors: Comparison | None
    held_out_errors: Comparison | None
    lambertian_errors: Comparison | None
    normal_error: float | None
    lambertian_normal_error: float | None
    notes: tuple[str, ...]
    seconds: float
    capture: ObjectCapture = field(repr=False)
    held_out_capture: ObjectCapture | None = field(repr=False)
    state: FittedObject = field(repr=False)

    @property
    def shape(self) -> tuple[int, int]:
        """The height and width of the maps, in pixels."""
        height, width = self.mask.shape
        return height, width

    def relight(self, direction: ArrayLike, *, irradiance: float | ArrayLike = 1.0) -> FloatArray:
        """Return a picture of the object under a distant light, without cast shadows.

        Parameters
        ----------
        direction : array_like, shape (3,)
            The direction towards the light: x to the right, y up, z towards the camera.
        irradiance : float or array_like, shape (3,), default 1
            Irradiance of a surface that faces the light [W/m²], in the units of the photographs.

        Returns
        -------
        ndarray, shape (height, width, 3)
            Radiance [W/(m² sr)].

        Raises
        ------
        BrdfkitError
            For a direction that is no vector, and an irradiance that is not one number or three.

        Examples
        --------
        >>> picture = maps.relight((0.5, 0.5, 0.7))    # doctest: +SKIP
        """
        towards = to_array("direction", direction, (3,))
        length = float(np.linalg.norm(towards))
        if not np.isfinite(length) or length == 0:
            raise wrong_value_error("direction", direction, "a vector towards the light")
        power = to_strength("irradiance", irradiance)
        return self.predict(Lights((towards / length)[None], power))[0]

    @in_turn
    def predict(self, lights: Lights) -> FloatArray:
        """Return pictures of the object under lights, without cast shadows.

        Parameters
        ----------
        lights : Lights
            Distant lights, or lamps.

        Returns
        -------
        ndarray, shape (lights, height, width, 3)
            Radiance [W/(m² sr)].

        Examples
        --------
        >>> pictures = maps.predict(maps.capture.lights)    # doctest: +SKIP
        """
        from brdfkit.inverse.photographs.objects.prediction import predict
        from brdfkit.inverse.photographs.objects.tile import Tile

        known = self.state.calibration
        assert known is not None  # maps are made of calibrated photographs only
        capture = self.capture
        tile = Tile.under_lights(lights, capture.points, capture.to_camera)
        parts = predict(tile, known.reflection, self.state.normals, self.state.weights)
        return np.array([capture.to_picture(values) for values, _ in parts])

    def scene_dict(self) -> dict[str, Any]:
        """Return the dictionary for `mitsuba.load_dict`: a rectangle with the object's maps."""
        from brdfkit.inverse.photographs.objects.scene import make_object_dict

        return make_object_dict(self)

    def write(self, folder: str | Path) -> list[Path]:
        """Write the maps, a Mitsuba scene and a report.

        Parameters
        ----------
        folder : str or Path
            The folder, which is made if it does not exist.

        Returns
        -------
        list of Path
            The files: an OpenEXR file for each map and, with ``_error`` in its name, for its
            standard error; ``lights.exr``; ``mask.png``; ``object.xml``, a scene under the first
            light; and ``report.html``. In the files of maps, pixels around the object have the
            values of its edge, so that textures can interpolate.

        Raises
        ------
        BrdfkitError
            For a folder to which nothing can be written.

        Examples
        --------
        >>> maps.write("cat")    # doctest: +SKIP
        """
        from brdfkit.inverse.photographs.objects.files import write_files

        return write_files(self, folder)

    def record(self) -> dict[str, Any]:
        """Return the findings as numbers and sentences, for ``brdfkit svbrdf --json``."""
        names = (
            "name",
            "model",
            "fixed",
            "exposures",
            "noise",
            "normal_error",
            "lambertian_normal_error",
            "notes",
            "seconds",
        )
        compared = {
            name: None if part is None else asdict(part)
            for name, part in (
                ("fitted_errors", self.fitted_errors),
                ("held_out_errors", self.held_out_errors),
                ("lambertian_errors", self.lambertian_errors),
            )
        }
        return {name: getattr(self, name) for name in names} | compared

    def document(self) -> Document:
        """Return the printed summary: a row for each map, errors of photographs, and notes."""
        return describe_object(self)
