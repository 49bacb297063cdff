"""`Pictures`: the pictures that a comparison keeps of one view in one light, for its page."""

from dataclasses import dataclass, field

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray, MitsubaObject
from brdfkit.shadows.comparison.exact_shadow import LitView
from brdfkit.shadows.comparison.map_pictures import CompressedArray, MapPictures


@dataclass
class Pictures:
    """The pictures of one view in one light, by exact shadows and by each technique.

    All of them are kept compressed.

    title : name of the view and the light.
    light : radiance (height, width, 3) of the surfaces by this light alone, without shadows.
    arrives, towards : the properties `exact` and `facing`.
    maps : for each pair of a projection and a partition, by label, the pictures of its maps.
    shares : for each technique, the share (height, width) of the light that arrives, 0 to 255.
    """

    title: str
    light: CompressedArray
    arrives: CompressedArray
    towards: CompressedArray
    maps: dict[str, MapPictures] = field(default_factory=dict)
    shares: dict[str, CompressedArray] = field(default_factory=dict)

    @classmethod
    def from_view(cls, view: LitView, title: str) -> "Pictures":
        """Return the pictures of a view, to which techniques are added later."""
        # Half precision suffices for pictures; its largest number limits the radiance, as infinity
        # could not be drawn
        radiance = np.minimum(view.unshadowed, np.finfo(np.float16).max).astype(np.float16)
        exact, facing = view.exact.reshape(view.size), view.facing.reshape(view.size)
        arrays = radiance.reshape(*view.size, 3), exact, facing
        light, arrives, towards = map(CompressedArray.from_array, arrays)
        return cls(title, light, arrives, towards)

    @property
    def is_lit(self) -> bool:
        """True if the light shines on any visible surface."""
        return bool(self.facing.any())

    @property
    def unshadowed(self) -> FloatArray:
        """The radiance (height, width, 3) of the surfaces by this light alone, without shadows."""
        return self.light.array.astype(np.float32)

    @property
    def exact(self) -> BoolArray:
        """True in pixels (height, width) where the light arrives, found with shadow rays."""
        return self.arrives.array

    @property
    def facing(self) -> BoolArray:
        """True in pixels (height, width) whose surface is lit if no shadows are cast."""
        return self.towards.array

    def add_technique(self, technique: str, lit: FloatArray) -> None:
        """Add the picture of a technique, given the share `lit` (pixels,) of light that arrives."""
        shares = np.round(255 * np.clip(lit, 0, 1)).astype(np.uint8)
        self.shares[technique] = CompressedArray.from_array(shares.reshape(self.arrives.shape))

    def lit(self, technique: str) -> FloatArray:
        """Return the share (height, width), 0 to 1, of the light that arrives with a technique."""
        return self.shares[technique].array / np.float32(255)

    def radiance(self, lit: AnyArray) -> FloatArray:
        """Return the picture (height, width, 3) if the share `lit` (height, width) arrives."""
        return self.unshadowed * lit[..., None]


def make_title(view: int, sensor: MitsubaObject, light: int, emitter: MitsubaObject) -> str:
    """Return a title with the numbers of a view and a light, and with their names in the scene."""
    camera, lamp = _format_object_name(sensor), _format_object_name(emitter)
    return f"View {view + 1}{camera}, light {light + 1}{lamp}"


def _format_object_name(thing: MitsubaObject) -> str:
    """Return the user's name for a Mitsuba object, in brackets, or "" if it has none."""
    return "" if thing.id().startswith("_") or not thing.id() else f" ({thing.id()})"
