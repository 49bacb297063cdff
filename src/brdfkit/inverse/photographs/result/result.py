"""`Svbrdf`, what `svbrdf` returns: maps of a sample, and how certain they are."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brdfkit.core.arguments import to_array, wrong_argument
from brdfkit.core.documents import Document, Paragraph, Shown, Table
from brdfkit.core.documents.parts import SOFT
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.observations import light_on


@dataclass(frozen=True, eq=False, repr=False)
class Svbrdf(Shown):
    """Maps of a flat sample: a model's parameters and the normal, texel by texel.

    Attributes
    ----------
    name : str
        What the sample is called.
    model : str
        Label of the model.
    maps : dict of str to ndarray
        The map of each parameter, (height, width), or (height, width, 3) in linear sRGB of weights;
        ``"normal"``, unit vectors (height, width, 3); and, where a material may be anisotropic,
        ``"anisotropy_angle"``, the direction of ``alpha_u`` [radians]. The first row is the
        sample's upper edge.
    fixed : dict of str to float
        Shape parameters that are alike everywhere. Where ``f0`` is, the reflectance at normal
        incidence is ``specular_reflectance`` times it.
    size : tuple of float
        The sample's width and height [m].
    smoothness : float
        By how much neighbouring texels may differ: weights relative to their median, logarithms of
        widths, and sines of the normal's angles.
    held_out : dict of float to float
        Smoothness that was tried → RMS relative error of lights that were held out.
    notes : tuple of str
        What else one should know, as what the lights leave open.
    seconds : float
        Wall-clock time.
    capture : Capture
        The photographs, smaller where the maps do not need all of their pixels.
    uncertainty : dict of str to ndarray
        The standard error (height, width) of each map, by the photographs' noise and what the model
        leaves of them; of the normal in radians. Empty where Ctrl-C ended the search.
    misfit : ndarray, shape (height, width), or None
        What each texel leaves of the photographs, in units of the noise: about 1 where the maps
        explain them. None where Ctrl-C ended the search.
    residual : float
        RMS relative difference of the maps from all photographs; nan where Ctrl-C came before
        any picture was rendered; then there are no `predicted` and `rendered` either.
    predicted : dict of str to float
        Name of each photograph → PSNR [dB] of Mitsuba's picture of the maps under its light.
    rendered : ndarray, shape (lights, height, width, 3), or None
        Mitsuba's pictures of the maps, as the photographs.
    """

    name: str
    model: str
    maps: dict[str, NDArray[np.float64]]
    fixed: dict[str, float]
    size: tuple[float, float]
    smoothness: float
    held_out: dict[float, float]
    notes: tuple[str, ...]
    seconds: float
    capture: Capture = field(repr=False)
    uncertainty: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    misfit: NDArray[np.float64] | None = None
    residual: float = math.nan
    predicted: dict[str, float] = field(default_factory=dict)
    rendered: NDArray[np.float32] | None = field(default=None, repr=False)

    @property
    def shape(self) -> tuple[int, int]:
        """(height, width) of the maps."""
        height, width = self.maps["normal"].shape[:2]
        return height, width

    def relight(
        self,
        position: ArrayLike,
        *,
        intensity: float | ArrayLike = 1.0,
        viewer: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """Radiance of every texel under another point light, direct light alone.

        Parameters
        ----------
        position : array_like, shape (3,)
            Where the light is [m]; the sample is in the plane z = 0, its middle at the origin.
        intensity : float or array_like, shape (3,), default 1
            Its radiant intensity [W/sr].
        viewer : array_like, shape (3,), optional
            From where the sample is seen [m]; by default by the first photograph's camera.

        Returns
        -------
        ndarray, shape (height, width, 3)
            Radiance [W/(m² sr)], from the sample's upper edge downwards.

        Raises
        ------
        BrdfkitError
            For a light or a viewer that is no point above the sample, and an intensity that is not
            one number or three.

        Examples
        --------
        >>> picture = maps.relight((0.1, 0.2, 0.5))    # doctest: +SKIP
        """
        points = self.capture.texels(self.shape)
        eye = self.capture.cameras[0].origin if viewer is None else _to_place("viewer", viewer)
        place = _to_place("position", position)[None]
        power = _to_intensity(intensity)
        from brdfkit.inverse.photographs.maps.prediction import predict

        to_light, irradiance = light_on(points, place, power)
        return predict(self, points, to_light, irradiance, eye)[0]

    def scene_dict(self) -> dict[str, Any]:
        """The dictionary for `mitsuba.load_dict`: the sample, a rectangle with its material."""
        from brdfkit.inverse.photographs.maps.scene import sample_dict

        return sample_dict(self)

    def write(self, folder: str | Path) -> list[Path]:
        """Write the maps, a scene of Mitsuba's and a report.

        Parameters
        ----------
        folder : str or Path
            Where to; it is made if it is not there.

        Returns
        -------
        list of Path
            The files: a map each as OpenEXR, with ``_error`` that of its standard error;
            ``sample.xml``, a scene with the sample under the first light; ``report.html``.

        Raises
        ------
        BrdfkitError
            Where nothing can be written.

        Examples
        --------
        >>> maps.write("paper")    # doctest: +SKIP
        """
        from brdfkit.inverse.photographs.result.files import write_all

        return write_all(self, folder)

    def document(self) -> Document:
        """A row for each map, notes, and how well it predicts."""
        rows = tuple(
            (name, *_summary(name, values), _median(name, self.uncertainty.get(name)))
            for name, values in self.maps.items()
        )
        height, width = self.shape
        tried = ", ".join(f"{tau:g}: {100 * e:.2g} %" for tau, e in self.held_out.items())
        chosen = f", by lights held out ({tried})" if tried else ""
        count = len(self.capture.names)
        return Document(
            f"{self.name}: {self.model}, {width} × {height} texels from {count} photographs",
            (
                Table(rows, ("map", ">5 %", ">median", ">95 %", ">± median")),
                *(Paragraph(note) for note in (*_fixed(self.fixed), *self.notes)),
                *_compared(self.residual, self.predicted.values()),
                Paragraph(
                    f"smoothness {self.smoothness:g}{chosen}; {self.seconds:.1f} s", kind=SOFT
                ),
            ),
        )


def _fixed(values):
    """What to know of the parameters that are alike everywhere."""
    if not values:
        return ()
    said = "Everywhere " + ", ".join(f"{name} = {value:g}" for name, value in values.items())
    at_normal = "; at normal incidence the specular reflectance counts times f0"
    return (f"{said}{at_normal if 'f0' in values else ''}.",)


def _compared(residual, dB):
    """How near Mitsuba's pictures come to the photographs, where there are any."""
    if not dB:
        return ()
    said = (
        f"Mitsuba's pictures of the maps are the photographs but for {100 * residual:.2g} % (RMS); "
        f"PSNR {min(dB):.1f} to {max(dB):.1f} dB."
    )
    return (Paragraph(said),)


def _summary(name, values):
    """5 %, median and 95 % of a map as texts; of normals the angle to z [degrees]."""
    if name == "normal":
        angle = np.degrees(np.arccos(np.clip(values[..., 2], -1, 1)))
        return tuple(f"{q:.2g}°" for q in np.quantile(angle, (0.05, 0.5, 0.95)))
    return tuple(f"{q:.3g}" for q in np.quantile(values, (0.05, 0.5, 0.95)))


def _median(name, errors):
    """The median of standard errors as a text, if there are any; of normals [degrees]."""
    if errors is None:
        return ""
    median = float(np.median(errors))
    return f"{np.degrees(median):.2g}°" if name == "normal" else f"{median:.2g}"


def _to_place(what: str, point: Any) -> NDArray[Any]:
    """Return a point above the sample as an array (3,) [m]."""
    place = to_array(what, point, (3,))
    if place[2] <= 0:
        raise wrong_argument(what, point, "above the sample, its z [m] above 0")
    return place


def _to_intensity(value: Any) -> NDArray[Any]:
    """Return the intensity of a light, one number or three, as an array (1, 3)."""
    intensity = to_array("intensity", value)
    if (
        intensity.shape not in ((), (1,), (3,))
        or not (np.isfinite(intensity) & (intensity >= 0)).all()
    ):
        raise wrong_argument("intensity", value, "a number, or three, 0 or above")
    return np.broadcast_to(intensity, (1, 3))
