"""Variants of Mitsuba in which a plugin runs."""

from brdfkit.core.errors import BrdfkitError


def refuse_scalar(plugin):
    """Raise `BrdfkitError` in scalar variants, for a `plugin` of this name that needs arrays."""
    import mitsuba as mi

    if mi.variant().startswith("scalar"):
        raise BrdfkitError(
            f"{plugin} does not run in {mi.variant()}; set llvm_ad_rgb or cuda_ad_rgb."
        )
