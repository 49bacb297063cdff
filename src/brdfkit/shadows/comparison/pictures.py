"""`Pictures`: what a comparison keeps of one view in one light, from which its page is drawn."""

from dataclasses import dataclass, field

import numpy as np

from brdfkit.shadows.comparison.map_pictures import MapPictures, Packed


@dataclass
class Pictures:
    """One view in one light, without a shadow, with the exact one, and with those of techniques.

    title : which view and which light.
    light : radiance (height, width, 3) of the surfaces by this light alone, unshadowed.
    arrives, towards : what `exact` and `facing` are.
    maps : projection and partition → its `MapPictures`.
    shares : technique → share of the light (height, width) that arrives, in 255ths.
    """

    title: str
    light: Packed
    arrives: Packed
    towards: Packed
    maps: dict[str, MapPictures] = field(default_factory=dict)
    shares: dict[str, Packed] = field(default_factory=dict)

    @classmethod
    def of(cls, seen, title):
        """Of a `Seen`."""
        height, width = seen.size
        return cls(
            title,
            Packed.of(halves(seen.unshadowed).reshape(height, width, 3)),
            Packed.of(seen.exact.reshape(seen.size)),
            Packed.of(seen.facing.reshape(seen.size)),
        )

    @property
    def is_lit(self):
        """Whether the light shines on anything that is seen."""
        return bool(self.facing.any())

    @property
    def unshadowed(self):
        """The radiance (height, width, 3) of the surfaces by this light alone."""
        return self.light.array.astype(np.float32)

    @property
    def exact(self):
        """Whether (height, width) the light arrives."""
        return self.arrives.array

    @property
    def facing(self):
        """Whether (height, width) there is a surface that faces the light, where it shines."""
        return self.towards.array

    def keep(self, technique, lit):
        """Keep the shares (pixels,) of the light that a technique lets through."""
        shares = np.round(255 * np.clip(lit, 0, 1)).astype(np.uint8)
        self.shares[technique] = Packed.of(shares.reshape(self.arrives.shape))

    def lit(self, technique):
        """The share of the light (height, width) that arrives by a technique."""
        return self.shares[technique].array / np.float32(255)

    def radiance(self, lit):
        """The picture (height, width, 3) by the shares (height, width) of the light that arrive."""
        return self.unshadowed * lit[..., None]


def halves(radiance):
    """Half precision, whose largest number is 65504."""
    return np.minimum(radiance, np.finfo(np.float16).max).astype(np.float16)


def title_of(view, sensor, light, emitter):
    """Which view and light, by numbers from 0, and by the names that the scene gives to them."""
    return f"View {view + 1}{_named(sensor)}, light {light + 1}{_named(emitter)}"


def _named(thing):
    """The name of one of Mitsuba's objects in brackets; nothing where Mitsuba made it up."""
    return "" if thing.id().startswith("_") or not thing.id() else f" ({thing.id()})"
