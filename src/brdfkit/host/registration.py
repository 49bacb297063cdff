"""Registers the plugins in Mitsuba: every kind, in every variant, each built when first used.

A plugin file holds either a `Model`, or a function ``define(mi)`` that returns a class derived from
one of Mitsuba's for the current variant. Where Mitsuba lets no class be written, as of shapes, it
returns a function of the properties that makes an instance.
"""

from functools import cache

import mitsuba as mi

from brdfkit.host import bsdf
from brdfkit.model import Model, labels
from brdfkit.plugins import discovery
from brdfkit.plugins.discovery import KINDS, MODELS

_registered: set[tuple[str, str, str]] = set()


def register_all():
    """Register what is not yet known in the current variant of Mitsuba, if one is set.

    A volume is not known in scalar_rgb. By what a name is registered there Mitsuba 3.9 tells its
    kind in every variant; a volume, registered as a texture, could be in no dictionary any more.
    """
    variant = mi.variant()
    if variant is None:
        return
    for kind, (_, register) in KINDS.items():
        if kind == "volumes" and variant == "scalar_rgb":
            continue
        for name in discovery.sources(kind):
            if (variant, kind, name) not in _registered:
                _registered.add((variant, kind, name))
                getattr(mi, register)(name, lambda props, k=kind, n=name: _plugin(k, n, props))


def _plugin(kind, name, props):
    """A plugin of the class that its file defines now, in the current variant."""
    source = discovery.sources(kind)[name]
    model = labels.model_in(source) if kind == MODELS else None
    if model is None:
        return _defined(discovery.module(source), mi.variant())(props)
    options = {option: props[option] for option in model.options if option in props}
    return _defined(model.configured(**options), mi.variant())(props)


@cache
def _defined(source, _variant):
    """The class of a `Model`, or of a module that defines it itself."""
    if isinstance(source, type) and issubclass(source, Model):
        return bsdf.define(mi, source)
    return source.define(mi)
