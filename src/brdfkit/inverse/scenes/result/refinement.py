"""Defines `Refinement`, the result of `refine`: values of parameters and their standard errors."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.documents import Document, Shown
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.inverse.scenes.problem.targets import find_white_level
from brdfkit.inverse.scenes.result.summary import describe_refinement
from brdfkit.regression import Fit
from brdfkit.regression.certainty import Certainty, make_confidence_intervals
from brdfkit.rendering.result import Rendering

Value = float | tuple[float, ...] | FloatArray


@dataclass(frozen=True, repr=False)
class Refinement(Shown):
    """Parameters of a scene whose rendered pictures match the given ones; prints as a table.

    Attributes
    ----------
    values : dict of str to float, tuple or ndarray
        The values that were found, by the names of `mitsuba.traverse` without ``.value`` at the
        end. A colour or a vector is a tuple; a texture is an array (height, width, channels), a
        volume an array (depth, height, width, channels). The ``to_world`` of a lamp is a tuple
        (x, y, z), its position, or the unit direction in which a distant lamp shines.
    loss : float
        The RMS difference E between rendered and given pixels, in shares of white (the brightest
        hundredth). Differences are weighted by the slope of sRGB's curve, as a screen shows them,
        and the noise of rendering is subtracted; 0 means that nothing but noise is left.
    noise : float
        The RMS noise of the last rendering, in units of the loss.
    samples : int
        Samples per pixel of the last rendering.
    steps : int
        Gauss-Newton or descent steps after the choice of the starting point.
    cost : float
        Samples per pixel of all renderings; derivatives count by the time they took.
    seconds : float
        Wall-clock time.
    message : str
        Why the search stopped.
    converged : bool
        Whether no step would gain more than the noise. Otherwise a line above the table says that
        the values are not final, and standard errors include the next step.
    history : tuple of (int, float)
        Samples per pixel and E² of each step; noise may make E² negative.
    at_bounds : tuple of str
        Names of the values that ended on a bound.
    notes : tuple of str
        Sentences about doubtful findings.
    certainty : Certainty
        How well the pictures determine the values; the same class as for a `Fit`.
    fits : dict of str to Fit
        A fit for each of brdfkit's models in the scene whose parameters were searched, by the name
        of its BSDF in the scene.
    names : tuple of str
        The names of the pictures, or their numbers, from "0" on.
    pictures : tuple of ndarray
        The last rendering of each picture, (height, width, channels), under its own lamps.
    targets : tuple of ndarray
        The given pictures, in linear values; NaN where they are masked.

    Notes
    -----
    Standard errors cover the noise of the pictures and of rendering, and model errors as far as
    they differ between blocks of pixels as wide as the camera's filter. Where neighbouring blocks
    agree, the residuals are not noise: a note gives the significance and a lower estimate of χ² per
    degree of freedom. Blocks that agree count as one, which multiplies the standard errors by the
    square root of their number. A camera or a light that is wrong may move the values by more than
    that, if its effect resembles theirs.

    The end of a search is checked with twice its samples. Where both agree, the values are the
    average of both; otherwise a note says so. If the end is worse than the scene's own values,
    these are returned, and the message says so.
    """

    values: dict[str, Value]
    loss: float
    noise: float
    samples: int
    steps: int
    cost: float = field(compare=False)
    seconds: float = field(compare=False)
    message: str
    converged: bool
    history: tuple[tuple[int, float], ...]
    at_bounds: tuple[str, ...]
    notes: tuple[str, ...]
    certainty: Certainty
    fits: dict[str, Fit]
    names: tuple[str, ...]
    pictures: tuple[FloatArray, ...] = field(compare=False)
    targets: tuple[FloatArray, ...] = field(compare=False)

    @property
    def fit(self) -> Fit:
        """The fit of the model, if exactly one model's parameters were searched.

        Raises `BrdfkitError` where there is none or several; ``fits`` has all of them.
        """
        if len(self.fits) != 1:
            known = ", ".join(self.fits) or "none"
            raise BrdfkitError(f"there is not one fit; `fits` has {known}.")
        return next(iter(self.fits.values()))

    @property
    def standard_errors(self) -> dict[str, Value]:
        """The standard errors of `values`; NaN for values that are on a bound or undetermined."""
        return self._arrange_like_values(self.certainty.compute_standard_errors())

    @property
    def intervals(self) -> dict[str, Any]:
        """The 95 % confidence intervals (low, high) of `values`, from Student's t distribution."""
        half_widths = self.certainty.compute_half_widths()
        return make_confidence_intervals(self.values, self._arrange_like_values(half_widths))

    @property
    def covariance(self) -> FloatArray:
        """The covariance matrix (n, n) of the values in ``certainty.names``."""
        return self.certainty.make_covariance_matrix()

    @property
    def correlation(self) -> FloatArray:
        """The correlation matrix (n, n) of the values in ``certainty.names``."""
        return self.certainty.compute_correlation()

    def look(self, picture: int | str = 0) -> Rendering:
        """Return a given picture and the rendered one, to compare them.

        Parameters
        ----------
        picture : int or str, default 0
            The number of the picture, or its name.

        Returns
        -------
        Rendering
            Both pictures in units of white, the brightest hundredth of the given one; masked pixels
            are black. A notebook shows them above their colour difference (CIEDE2000); ``write``
            makes a PNG or EXR file, and ``errors`` computes error measures. A notebook shows a
            `Refinement` with the comparisons of all pictures.

        Raises
        ------
        BrdfkitError
            For a picture that does not exist.

        Examples
        --------
        >>> result.look().write("look.png")    # doctest: +SKIP
        """
        if isinstance(picture, str):
            if picture not in self.names:
                raise no_such_error("picture", picture, self.names)
            picture = self.names.index(picture)
        if not 0 <= picture < len(self.pictures):
            raise BrdfkitError(
                f"look: picture = {picture!r} should be 0 to {len(self.pictures) - 1}."
            )
        target, rendered = self.targets[picture], self.pictures[picture]
        unmasked = np.asarray(np.isfinite(target).all(axis=2))
        white = find_white_level(target[unmasked])
        shown = {
            name: np.where(unmasked[..., None], pixels / white, 0) * np.ones(3, np.float32)
            for name, pixels in (("given", target), ("found", rendered))
        }
        return Rendering(shown, self.samples, self.seconds, mask=unmasked)

    def put_into(self, scene: Any) -> Any:
        """Write the values into a scene, to render it or to refine it further.

        Parameters
        ----------
        scene : mitsuba.Scene, dict or path
            The scene that `refine` received, or another one with parameters of the same names.
            Load a `mitsuba.Scene` with ``optimize=False``; otherwise Mitsuba merges equal
            materials, and names are missing. Dictionaries and files are loaded so.

        Returns
        -------
        mitsuba.Scene
            The scene, with the values.

        Raises
        ------
        BrdfkitError
            For a scene that does not load, or that lacks one of the parameters.

        Examples
        --------
        >>> mitsuba.render(result.put_into("scene.xml"), spp=256)    # doctest: +SKIP
        """
        from brdfkit.inverse.scenes.problem.scene import load_scene
        from brdfkit.inverse.scenes.problem.scene_parameters import write_scene_values

        height, width = self.pictures[0].shape[:2]
        scene = load_scene(scene, (width, height))
        write_scene_values(scene, self.values)
        return scene

    def __eq__(self, other: object) -> bool:
        """Return whether two results are equal but for their times, costs and pictures."""
        if not isinstance(other, Refinement):
            return NotImplemented
        plain = [f.name for f in fields(self) if f.compare and f.name != "values"]
        return (
            all(getattr(self, name) == getattr(other, name) for name in plain)
            and self.values.keys() == other.values.keys()
            and all(np.array_equal(v, other.values[name]) for name, v in self.values.items())
        )

    __hash__ = None  # type: ignore[assignment]

    def _arrange_like_values(self, known: dict[str, float]) -> dict[str, Any]:
        """Return numbers by name in the shapes of `values`: tuples and arrays, NaN if unknown."""
        nan = float("nan")
        return {
            name: np.full(value.shape, nan)
            if isinstance(value, np.ndarray)
            else tuple(known.get(f"{name}[{i}]", nan) for i in range(len(value)))
            if isinstance(value, tuple)
            else known.get(name, nan)
            for name, value in self.values.items()
        }

    def document(self) -> Document:
        """Return the printed summary: values with errors, pictures and notes."""
        return describe_refinement(self)
