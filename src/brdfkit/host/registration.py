"""Registers the plugins in Mitsuba: every kind, in every variant, each built when first used.

A plugin file holds either a `Model`, or a function ``define(mi)`` that returns a class of Mitsuba's
for the current variant (or, where Mitsuba lets no class be written, a function of its properties).
"""

from functools import cache

import mitsuba as mi

from brdfkit.host import bsdf
from brdfkit.model import Model, labels
from brdfkit.plugins import discovery
from brdfkit.plugins.discovery import KINDS, MODELS

_registered: set[tuple[str, str, str]] = set()


def register_all():
    """Register what is not yet known in the current variant of Mitsuba, if one is set."""
    variant = mi.variant()
    if variant is None:
        return
    for kind, (_, register) in KINDS.items():
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
