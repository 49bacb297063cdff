"""`environments.audit` measures the light of an environment map, and looks for its defects."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import AnyArray
from brdfkit.core.colours import luminance
from brdfkit.core.documents import Document, Paragraph, Picture, Shown, Table
from brdfkit.core.documents.parts import BAD
from brdfkit.lighting.environments.light_distribution import (
    pixel_directions,
    pixel_solid_angles,
    share_of_brightest,
    weighted_median,
)
from brdfkit.lighting.environments.map_files import (
    EIGHT_BIT_WARNING,
    LARGEST_HALF_FLOAT,
    LATLONG,
    is_eight_bit,
    load_map,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# `brightest_share` is the share of the light that comes from this share of all directions
BRIGHTEST = 0.01
# The audit reports larger values than these as likely defects
ASPECT_TOLERANCE = 0.05  # relative deviation of width / height from 2
EQUAL_TOLERANCE = 4  # number of pixels with the largest brightness; more suggest clipping
BELOW_TOLERANCE = 2.0  # ratio of the light from below the horizon to that from above
DPI, WIDTH = 75, 760  # resolution and width [pixels] of the picture in a notebook


@dataclass(frozen=True, repr=False)
class EnvironmentAudit(Shown):
    """The light of an environment map and its likely defects, which print as text.

    Directions are those of Mitsuba's `envmap`: +y is up, and +z is in the middle of the picture.
    Pixels that are negative or not finite count as black.

    Attributes
    ----------
    name : str
        The map's path or name.
    height, width : int
        Size [pixels].
    colour : tuple of float
        Mean radiance over all directions, in linear R, G, B.
    mean, median, largest : float
        Mean, median and largest luminance over all directions.
    brightest_share : float
        Share of the light that comes from the brightest 1 % of the solid angle.
    above : float
        Share of the light that comes from above the horizon.
    brightest : tuple of float
        The direction (x, y, z) of the brightest pixel.
    not_finite, negative : int
        Numbers of pixels that are not finite and that are negative, in any channel.
    equal : int
        Number of pixels that are as bright as the brightest one.
    eight_bit : bool
        Whether the file has 8 bits per channel, so that nothing is brighter than white.
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
    data: AnyArray = field(repr=False, compare=False)

    def rows(self) -> dict[str, str]:
        """Return the lines of the audit's text as {heading: text}, such as size and luminance."""
        x, y, z = self.brightest
        elevation, azimuth = math.degrees(math.asin(y)), math.degrees(math.atan2(x, z))
        r, g, b = self.colour
        return {
            "size": f"{self.width} × {self.height} pixels",
            "luminance": f"mean {self.mean:.4g}, median {self.median:.4g}, max {self.largest:.4g}",
            "mean colour": f"R {r:.4g}, G {g:.4g}, B {b:.4g}",
            "dynamic range": self._describe_dynamic_range(),
            "brightest 1 %": f"{_format_percent(self.brightest_share)} of the light comes from the "
            "brightest 1 % of the solid angle",
            "from above": f"{_format_percent(self.above)} of the light comes from above the "
            "horizon",
            "brightest spot": f"towards ({x:.2f}, {y:.2f}, {z:.2f}): {elevation:.0f}° above the "
            f"horizon, {azimuth:.0f}° from +z towards +x",
            "not finite": f"{self.not_finite:,} pixels; negative: {self.negative:,}",
        }

    def findings(self) -> tuple[str, ...]:
        """Return a sentence for each likely defect of the map."""
        sentences = []
        if self.not_finite:
            sentences.append(
                f"{self.not_finite:,} pixels are not finite: no renderer can use the map"
            )
        if self.negative:
            sentences.append(
                f"{self.negative:,} pixels are negative: light is never below 0; correct them"
            )
        if abs(self.width / self.height / LATLONG - 1) > ASPECT_TOLERANCE:
            sentences.append(
                f"{self.width} × {self.height} pixels are not twice as wide as high: perhaps "
                "another layout than latitude and longitude; 'brdfkit convert --source' converts it"
            )
        if self.eight_bit:
            sentences.append(EIGHT_BIT_WARNING)
        if not self.largest:
            return (*sentences, "the map is black: it lights nothing")
        if self.equal == self.width * self.height:
            return (*sentences, "all pixels are equal: the map has no lamps, and casts no shadows")
        if self.equal > EQUAL_TOLERANCE and not self.eight_bit:
            limit = ", the largest half float" if self.data.max() >= LARGEST_HALF_FLOAT else ""
            sentences.append(
                f"{self.equal:,} pixels share the largest luminance, {self.largest:.4g}{limit}: "
                "clipped, unless a computer made the map"
            )
        if 1 - self.above > BELOW_TOLERANCE * self.above:
            sentences.append(
                f"{_format_percent(1 - self.above)} of the light comes from below: perhaps upside "
                "down"
            )
        return tuple(sentences)

    def picture(self) -> Figure:
        """Draw the map, the blocks by which `kdtree_envmap` samples it, and its light's spread.

        >>> environments.audit("studio").picture().savefig("studio.png")    # doctest: +SKIP
        """
        from brdfkit.lighting.environments.audit_picture import (
            draw_audit,  # imported only here, because matplotlib loads slowly
        )

        return draw_audit(self)

    def document(self) -> Document:
        """Return the audit with its picture as a `Document`, for terminals and notebooks."""
        return Document(
            self.name,
            (
                Picture(
                    self._draw_png, f"{self.name}: the map, and how its light is spread", WIDTH
                ),
                Table(tuple(self.rows().items())),
                *(Paragraph(finding, BAD) for finding in self.findings()),
            ),
        )

    def _draw_png(self) -> bytes:
        """Return the picture as the bytes of a PNG file."""
        from brdfkit.core.figures import to_png

        return to_png(self.picture(), DPI)

    def _describe_dynamic_range(self) -> str:
        """Format the ratio of the largest luminance to the median."""
        if not self.median:
            return "without bound: half of the directions are black"
        ratio = self.largest / self.median
        return f"max over median {ratio:.3g}, {math.log2(ratio):.1f} stops"


def audit(environment: str | Path | NDArray[Any]) -> EnvironmentAudit:
    """Measure the brightness of an environment map by direction, and look for its defects.

    Parameters
    ----------
    environment : str, Path or ndarray
        The map by latitude and longitude: a file, the name of a map that comes with brdfkit, or
        radiance (height, width, 3) in linear sRGB.

    Returns
    -------
    EnvironmentAudit
        Prints as text; `findings()` lists likely defects, `picture()` is a matplotlib `Figure`.

    Raises
    ------
    BrdfkitError
        If the file cannot be read, or the map has fewer than 2×2 pixels.

    Examples
    --------
    >>> environments.audit("sky").brightest_share > 0.5    # the sun
    True
    """
    name, data = load_map(environment)
    finite, negative = np.all(np.isfinite(data), axis=2), np.any(data < 0, axis=2)
    rgb = np.where((finite & ~negative)[..., None], data, 0).astype(float)
    height, width = rgb.shape[:2]
    solid_angle = pixel_solid_angles(height, width)
    weight = solid_angle / solid_angle.sum()
    brightness = luminance(rgb)
    power = weight * brightness
    directions = pixel_directions(height, width)
    total = power.sum()
    return EnvironmentAudit(
        name=name,
        height=height,
        width=width,
        colour=tuple((weight[..., None] * rgb).sum(axis=(0, 1)).tolist()),
        mean=float(total),
        median=weighted_median(brightness, weight),
        largest=float(brightness.max()),
        brightest_share=share_of_brightest(brightness, weight, BRIGHTEST) if total else np.nan,
        above=float(power[directions[..., 1] > 0].sum() / total) if total else np.nan,
        brightest=tuple(directions.reshape(-1, 3)[brightness.argmax()].tolist()),
        not_finite=int((~finite).sum()),
        negative=int(negative.sum()),
        equal=int((brightness == brightness.max()).sum()),
        eight_bit=is_eight_bit(environment),
        data=data,
    )


def _format_percent(share: float) -> str:
    """Format a share in percent; NaN, the share of a black map, becomes "no share"."""
    return "no share" if math.isnan(share) else f"{100 * share:.3g} %"
