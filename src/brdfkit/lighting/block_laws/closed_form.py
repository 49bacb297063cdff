"""Chooses blocks in Mitsuba by a law whose F⁻¹ has a closed form: no table, no search."""

import dataclasses


class ClosedForm:
    """A law, a frozen dataclass that computes by the functions of its module `maths`.

    `maths` is `numpy`, or `drjit` in the renderer; functions are called as both name them.
    """

    def in_renderer(self):
        """The same law in Mitsuba's current variant; its parameters are opaque to kernels."""
        import drjit as dr

        given = {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}
        numbers = {name: _opaque(v) for name, v in given.items() if name not in ("n", "maths")}
        return dataclasses.replace(self, n=_opaque(float(self.n)), maths=dr, **numbers)

    def choose(self, u, active):
        """(Block, what is left of `u`, probability of the block)."""
        import drjit as dr
        import mitsuba as mi

        i = dr.minimum(dr.floor(self.inverse(u)), self.n - 1)
        probability = self.probability(i)
        rest = (u - self.cumulative(i)) / dr.maximum(probability, 1e-30)
        return mi.UInt32(i), dr.clip(rest, 0, 1), probability

    nbytes = 0  # of tables


def _opaque(value):
    """A number, or a tuple of numbers, that kernels do not contain: any value has one kernel."""
    import drjit as dr
    import mitsuba as mi

    if isinstance(value, tuple):
        return tuple(_opaque(number) for number in value)
    opaque = mi.Float(float(value))
    dr.make_opaque(opaque)
    return opaque
