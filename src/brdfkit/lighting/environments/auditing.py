"""`environments.audit`: how bright an environment map is and from where, and doubtful values."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.colours import luminance
from brdfkit.core.documents import Document, Paragraph, Picture, Shown, Table
from brdfkit.core.documents.parts import BAD
from brdfkit.lighting.environments import report
from brdfkit.lighting.environments.map_files import is_eight_bit, load
from brdfkit.lighting.environments.spread import (
    directions,
    median,
    share_of_brightest,
    solid_angles,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHARE = 0.01  # of the solid angle, in which the brightest light is summed up
DPI, WIDTH = 75, 760  # of the picture in a notebook


@dataclass(frozen=True, repr=False)
class EnvironmentAudit(Shown):
    """What is in an environment map; prints as text. Made by `environments.audit`.

    Directions are those of Mitsuba's `envmap`: +y is up, the middle of the picture is +z. Pixels
    that are not finite, or negative, count as black.

    Attributes
    ----------
    name : str
        The map's path or name.
    height, width : int
        Size [pixels].
    colour : tuple of float
        Mean radiance over all directions, in linear R, G, B.
    mean, median, largest : float
        Of the luminance over all directions.
    brightest_share : float
        Share of the light that comes from the brightest 1 % of the solid angle.
    above : float
        Share of the light that comes from above the horizon.
    brightest : tuple of float
        The direction (x, y, z) of the brightest pixel.
    not_finite, negative : int
        Number of pixels that are not finite, and that are negative, in any channel.
    equal : int
        Number of pixels that are as bright as the brightest one.
    eight_bit : bool
        Whether the file has 8 bits per channel, and so nothing brighter than white.
    data : ndarray
        The map (height, width, 3).
    """

    name: str
    height: int
    width: int
    colour: tuple[float, ...]
    mean: float
    median: float
    largest: float
    brightest_share: float
    above: float
    brightest: tuple[float, ...]
    not_finite: int
    negative: int
    equal: int
    eight_bit: bool
    data: Any = field(repr=False, compare=False)

    def rows(self) -> dict[str, str]:
        """The audit in words, by heading."""
        return report.rows(self)

    def findings(self) -> tuple[str, ...]:
        """Sentences on what is doubtful."""
        return report.findings(self)

    def picture(self) -> "Figure":
        """The map with the blocks that `kdtree_envmap` cuts it into, and how the light is spread.

        >>> environments.audit("studio").picture().savefig("studio.png")    # doctest: +SKIP
        """
        from brdfkit.lighting.environments.picture import picture  # only here: matplotlib is slow

        return picture(self)

    def document(self) -> Document:
        """How bright the map is, from where, and what is doubtful."""
        return Document(
            self.name,
            (
                Picture(self._draw, f"{self.name}: the map, and how its light is spread", WIDTH),
                Table(tuple(self.rows().items())),
                *(Paragraph(finding, BAD) for finding in self.findings()),
            ),
        )

    def _draw(self):
        from brdfkit.core.figures import to_png

        return to_png(self.picture(), DPI)


def audit(environment: str | Path | NDArray[Any]) -> EnvironmentAudit:
    """How bright an environment map is, from where, and what is doubtful in it.

    Parameters
    ----------
    environment : str, Path or ndarray
        The map by latitude and longitude: a file, the name of a map that comes with brdfkit, or
        radiance (height, width, 3) in linear sRGB.

    Returns
    -------
    EnvironmentAudit
        Prints as text; `findings()` are its doubts, `picture()` is a matplotlib `Figure`.

    Raises
    ------
    BrdfkitError
        For a file that cannot be read, and for a map of fewer than 2×2 pixels.

    Examples
    --------
    >>> environments.audit("sky").brightest_share > 0.5    # the sun
    True
    """
    name, data = load(environment)
    finite, negative = np.isfinite(data).all(axis=2), (data < 0).any(axis=2)
    rgb = np.where((finite & ~negative)[..., None], data, 0).astype(float)
    height, width = rgb.shape[:2]
    solid_angle = solid_angles(height, width)
    weight = solid_angle / solid_angle.sum()
    bright = luminance(rgb)
    power = weight * bright
    towards = directions(height, width)
    total = power.sum()
    return EnvironmentAudit(
        name=name,
        height=height,
        width=width,
        colour=tuple((weight[..., None] * rgb).sum(axis=(0, 1)).tolist()),
        mean=float(total),
        median=median(bright, weight),
        largest=float(bright.max()),
        brightest_share=share_of_brightest(bright, weight, SHARE) if total else np.nan,
        above=float(power[towards[..., 1] > 0].sum() / total) if total else np.nan,
        brightest=tuple(towards.reshape(-1, 3)[bright.argmax()].tolist()),
        not_finite=int((~finite).sum()),
        negative=int(negative.sum()),
        equal=int((bright == bright.max()).sum()),
        eight_bit=is_eight_bit(environment),
        data=data,
    )
