"""`Refinement`, what `refine` returns: numbers of a scene, and how they were found."""

from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.documents import Cell, Document, Paragraph, Picture, Shown, Table
from brdfkit.core.documents.parts import BAD, SOFT
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.scenes.problem.targets import white_of
from brdfkit.regression import Fit
from brdfkit.regression.certainty import Certainty, intervals
from brdfkit.rendering.montage import TILE
from brdfkit.rendering.result import WIDEST, Rendering

Value = float | tuple[float, ...] | NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Refinement(Shown):
    """Numbers of a scene that make its pictures those that are given; prints as a table.

    Attributes
    ----------
    values : dict
        What was found, by the names of `mitsuba.traverse` without a ``.value`` at the end; a
        colour or a vector is a tuple, a texture or a volume an array, (height, width, channels) or
        (depth, height, width, channels).
    loss : float
        E, the RMS difference of pixels as a screen shows them, by the slope of sRGB's curve, in
        shares of white (the brightest hundredth), the noise of rendering taken out; 0 where nothing
        else is left.
    noise : float
        The RMS noise of the last rendering, in units of the loss.
    samples : int
        Samples per pixel of the last rendering.
    steps : int
        Steps of Gauss and Newton, after the start.
    cost : float
        Samples per pixel of all renderings, derivatives counted by their time.
    seconds : float
        Wall-clock time.
    message : str
        Why the search stopped.
    converged : bool
        Whether no step would gain more than the noise. Otherwise the values are on their way: it
        says so above the table, and the step that came next is in the standard errors.
    history : tuple of (int, float)
        Samples per pixel and E² of each step; E² may be below 0, by noise.
    at_bounds : tuple of str
        Values that ended on a bound.
    notes : tuple of str
        What else one should know.
    certainty : Certainty
        What the pictures say of the values, as of a `Fit`.
    fits : dict of str to Fit
        A fit for each of brdfkit's models in the scene whose parameters were searched, by the name
        of its BSDF in the scene.
    pictures : tuple of ndarray
        The last rendering of each sensor, (height, width, channels).
    reached : tuple of ndarray
        What `refine` was given for each of them, linear; NaN where it is masked.

    Notes
    -----
    Standard errors hold the noise of the pictures and of rendering, and what the scene cannot
    explain, as far as it differs from one block of pixels to the next, which is as wide as the
    camera's filter. Where blocks beside each other differ alike, what is left is no noise: a note
    says by how many standard errors, with the least χ² per degree of freedom, and as many blocks
    as are alike count as one, which makes the standard errors larger by the root of their number.
    A camera or a light that is off moves the values by more than that, if it looks like them.

    The end of a search is looked at with twice its samples, other ones. Where both agree, the
    values are the mean of both; where they do not, a note says so. If the end is worse than the
    scene's own values, these are returned, and the message says so.
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
    pictures: tuple[NDArray[np.float64], ...] = field(compare=False)
    reached: tuple[NDArray[np.float64], ...] = field(compare=False)

    @property
    def fit(self) -> Fit:
        """The fit of the only model that was searched.

        Raises `BrdfkitError` where there are none or several: see ``fits``.
        """
        if len(self.fits) != 1:
            known = ", ".join(self.fits) or "none"
            raise BrdfkitError(f"there is not one fit; `fits` has {known}.")
        return next(iter(self.fits.values()))

    @property
    def standard_errors(self) -> dict[str, Value]:
        """The standard errors of `values`; NaN for what is on a bound or undetermined."""
        return self._by_value(self.certainty.standard_errors())

    @property
    def intervals(self) -> dict[str, Any]:
        """The 95 % confidence intervals (low, high) of `values`, by Student's t."""
        return intervals(self.values, self._by_value(self.certainty.half_widths()))

    @property
    def covariance(self) -> NDArray[np.float64]:
        """The covariance (n, n) of ``certainty.names``."""
        return self.certainty.matrix()

    @property
    def correlation(self) -> NDArray[np.float64]:
        """The correlation (n, n) of ``certainty.names``."""
        return self.certainty.correlation()

    def look(self, sensor: int = 0) -> Rendering:
        """The picture that was given beside the one that was found, and how they differ.

        Parameters
        ----------
        sensor : int, default 0
            The number of the picture.

        Returns
        -------
        Rendering
            Both in shares of white, the brightest hundredth of what was given, black where it is
            masked; a notebook shows them over their difference in colour (CIEDE2000), ``write``
            writes that as PNG or EXR, and ``errors`` compares them. A notebook shows a `Refinement`
            with all of them.

        Raises
        ------
        BrdfkitError
            For a number that no picture has.

        Examples
        --------
        >>> found.look().write("look.png")    # doctest: +SKIP
        """
        if not 0 <= sensor < len(self.pictures):
            raise BrdfkitError(
                f"look: sensor = {sensor!r} should be 0 to {len(self.pictures) - 1}."
            )
        reached, found = self.reached[sensor], self.pictures[sensor]
        seen = np.asarray(np.isfinite(reached).all(axis=2))
        white = white_of(reached[seen])
        shown = {
            name: np.where(seen[..., None], picture / white, 0) * np.ones(3, np.float32)
            for name, picture in (("given", reached), ("found", found))
        }
        return Rendering(shown, self.samples, self.seconds, mask=seen)

    def put_into(self, scene: Any) -> Any:
        """Give a scene the values, to render it or to go on with it.

        Parameters
        ----------
        scene : mitsuba.Scene, dict or path
            What `refine` was given, or another scene with parameters of these names. A
            `mitsuba.Scene` has those of `refine` if it was loaded with ``optimize=False``, lest
            Mitsuba merge equal materials; dictionaries and files are loaded so here.

        Returns
        -------
        mitsuba.Scene
            The scene, with the values.

        Raises
        ------
        BrdfkitError
            For a scene that does not load, or is without one of them.

        Examples
        --------
        >>> mitsuba.render(found.put_into("scene.xml"), spp=256)    # doctest: +SKIP
        """
        from brdfkit.inverse.scenes.problem.scene import load_subject
        from brdfkit.inverse.scenes.problem.scene_parameters import put_values

        height, width = self.pictures[0].shape[:2]
        scene = load_subject(scene, (width, height))
        put_values(scene, self.values)
        return scene

    def __eq__(self, other: object) -> bool:
        """Whether all but times and pictures is equal."""
        if not isinstance(other, Refinement):
            return NotImplemented
        plain = [f.name for f in fields(self) if f.compare and f.name != "values"]
        return (
            all(getattr(self, name) == getattr(other, name) for name in plain)
            and self.values.keys() == other.values.keys()
            and all(np.array_equal(v, other.values[name]) for name, v in self.values.items())
        )

    __hash__ = None  # type: ignore[assignment]

    def _by_value(self, known):
        nan = float("nan")
        return {
            name: np.full(value.shape, nan)
            if isinstance(value, np.ndarray)
            else tuple(known.get(f"{name}[{i}]", nan) for i in range(len(value)))
            if isinstance(value, tuple)
            else known.get(name, nan)
            for name, value in self.values.items()
        }

    def _picture(self, sensor):
        """That of `look`, drawn when it is shown."""
        width = min(WIDEST, 2 * max(self.pictures[sensor].shape[1], TILE))
        says = f"given and found pictures {sensor}, and their difference"
        return Picture(lambda: self.look(sensor).drawn(), says, width)

    def document(self) -> Document:
        """The values with their standard errors, notes, and how they were found."""
        errors = self.standard_errors
        rows = tuple(
            (
                name,
                Cell(_numbers(value, errors[name]), colour=_colour(value)),
                Cell("on its bound", kind=BAD) if name in self.at_bounds else "",
            )
            for name, value in self.values.items()
        )
        several = "s" * (self.steps != 1)
        early = f"Not converged, and the values are not final: {self.message}."
        return Document(
            f"Refined: what is left is {100 * self.loss:.2g} % of white (RMS)",
            (
                *(Paragraph(early, kind=BAD) for _ in range(not self.converged)),
                Table(rows),
                *(self._picture(sensor) for sensor in range(len(self.pictures))),
                *(Paragraph(note) for note in self.notes),
                Paragraph(
                    f"{self.message}; {self.steps} step{several}, the last at {self.samples} "
                    f"samples per pixel, {self.seconds:.1f} s",
                    kind=SOFT,
                ),
            ),
        )


def _numbers(value, error):
    if isinstance(value, np.ndarray):
        shape = " × ".join(map(str, value.shape))
        return f"{shape}, {value.min():.3g} to {value.max():.3g}, mean {value.mean():.4g}"
    pairs = zip(np.atleast_1d(value), np.atleast_1d(error), strict=True)
    return "  ".join(f"{v:.5g}" if np.isnan(e) else f"{v:.5g} ± {e:.2g}" for v, e in pairs)


def _colour(value):
    return value if isinstance(value, tuple) and len(value) == 3 and min(value) >= 0 else ()
