"""Defines `Svbrdf`, the result of `svbrdf`: maps of a sample and their standard errors."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from brdfkit.core.arguments import to_array, wrong_value_error
from brdfkit.core.array_types import ArrayLike, FloatArray
from brdfkit.core.documents import Document, Shown
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.lights import to_strength
from brdfkit.inverse.photographs.capture.observations import illuminate_points
from brdfkit.inverse.photographs.result.comparison import Comparison
from brdfkit.inverse.photographs.result.summary import describe_svbrdf


@dataclass(frozen=True, eq=False, repr=False)
class Svbrdf(Shown):
    """Maps of a flat sample: textures of a model's parameters and of the normal.

    Attributes
    ----------
    name : str
        The sample's name.
    model : str
        Label of the model.
    maps : dict of str to ndarray
        The map of each parameter, (height, width), or (height, width, 3) in linear sRGB for the
        weights of lobes; ``"normal"``, unit vectors (height, width, 3); and, for anisotropic maps,
        ``"anisotropy_angle"``, the direction of ``alpha_u`` [radians]. The first row is the
        sample's upper edge.
    fixed : dict of str to float
        Shape parameters with one value everywhere. If ``f0`` is one of them, the reflectance at
        normal incidence is ``specular_reflectance`` times it.
    size : tuple of float
        Width and height of the sample [m].
    smoothness : float
        The typical difference of neighbouring texels: of weights relative to their lobe's
        brightness, of logarithms of widths, and of x and y of the normal.
    held_out : dict of float to float
        The RMS relative error of held-out photographs for each smoothness that was tried.
    notes : tuple of str
        Sentences about doubtful findings, such as numbers that the lights leave undetermined.
    seconds : float
        Wall-clock time.
    capture : Capture
        The photographs, reduced where the maps do not need all of their pixels.
    uncertainty : dict of str to ndarray
        The standard error (height, width) of each map. For the normal it is that of the angle to
        the true one [radians], of which 95 % are within 1.96. It covers the noise of the
        photographs, lost details and what the model does not explain. Empty where Ctrl-C ended the
        search.
    misfit : ndarray, shape (height, width), or None
        The residual of each texel in units of the noise: about 1 where the maps explain the
        photographs. None where Ctrl-C ended the search.
    residual : float
        The RMS relative difference of Mitsuba's renderings from all photographs; nan where Ctrl-C
        came before the first rendering; `predicted` and `rendered` are then empty, too.
    predicted : dict of str to float
        The PSNR [dB] of Mitsuba's rendering of each photograph, by its name.
    rendered : ndarray, shape (lights, height, width, 3), or None
        Mitsuba's renderings of the photographs.
    held_out_errors : Comparison, or None
        The relative errors of photographs that the argument `hold_out` kept out of the fit.
    """

    name: str
    model: str
    maps: dict[str, FloatArray]
    fixed: dict[str, float]
    size: tuple[float, float]
    smoothness: float
    held_out: dict[float, float]
    notes: tuple[str, ...]
    seconds: float
    capture: Capture = field(repr=False)
    uncertainty: dict[str, FloatArray] = field(default_factory=dict)
    misfit: FloatArray | None = None
    residual: float = math.nan
    predicted: dict[str, float] = field(default_factory=dict)
    rendered: FloatArray | None = field(default=None, repr=False)
    held_out_errors: Comparison | None = None

    @property
    def shape(self) -> tuple[int, int]:
        """The height and width of the maps, in texels."""
        height, width = self.maps["normal"].shape[:2]
        return height, width

    def relight(
        self,
        position: ArrayLike,
        *,
        intensity: float | ArrayLike = 1.0,
        viewer: ArrayLike | None = None,
    ) -> FloatArray:
        """Return the radiance of every texel under another point light, for direct light alone.

        Parameters
        ----------
        position : array_like, shape (3,)
            The position of the light [m]; the sample lies in the plane z = 0, around the origin.
        intensity : float or array_like, shape (3,), default 1
            Radiant intensity of the light [W/sr].
        viewer : array_like, shape (3,), optional
            The position of the viewer [m]; by default that of the first photograph's camera.

        Returns
        -------
        ndarray, shape (height, width, 3)
            Radiance [W/(m² sr)], from the sample's upper edge downwards.

        Raises
        ------
        BrdfkitError
            For a light or a viewer that is not a point above the sample, and an intensity that is
            not one number or three.

        Examples
        --------
        >>> picture = maps.relight((0.1, 0.2, 0.5))    # doctest: +SKIP
        """
        points = self.capture.texel_centres(self.shape)
        eye = (
            self.capture.cameras[0].origin if viewer is None else _to_point_above("viewer", viewer)
        )
        place = _to_point_above("position", position)[None]
        power = to_strength("intensity", intensity)
        from brdfkit.inverse.photographs.maps.maps import predict_radiances

        to_light, irradiance = illuminate_points(points, place, power)
        return predict_radiances(self, points, to_light, irradiance, eye)[0]

    def scene_dict(self) -> dict[str, Any]:
        """Return the dictionary for `mitsuba.load_dict`: a rectangle with the sample's material."""
        from brdfkit.inverse.photographs.maps.scene import make_sample_dict

        return make_sample_dict(self)

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
            standard error; ``sample.xml``, a scene of the sample under the first light; and
            ``report.html``.

        Raises
        ------
        BrdfkitError
            For a folder to which nothing can be written.

        Examples
        --------
        >>> maps.write("paper")    # doctest: +SKIP
        """
        from brdfkit.inverse.photographs.result.files import write_files

        return write_files(self, folder)

    def record(self) -> dict[str, Any]:
        """Return the findings as numbers and sentences, for ``brdfkit svbrdf --json``."""
        names = "smoothness", "residual", "held_out", "predicted", "notes", "seconds"
        errors = None if self.held_out_errors is None else asdict(self.held_out_errors)
        return {name: getattr(self, name) for name in names} | {"held_out_errors": errors}

    def document(self) -> Document:
        """Return the printed summary: a row for each map, notes, and the errors of renderings."""
        return describe_svbrdf(self)


def _to_point_above(what: str, point: Any) -> FloatArray:
    """Return a user's point as an array (3,) [m]; raise `BrdfkitError` unless it has z > 0."""
    place = to_array(what, point, (3,))
    if place[2] <= 0:
        raise wrong_value_error(what, point, "above the sample, its z [m] above 0")
    return place
