"""Registers the plugins in Mitsuba: every kind, in every variant, each made when first used.

A plugin file holds either a `Model`, or a function ``define(mi)`` that returns a class derived from
one of Mitsuba's for the current variant. Where Mitsuba allows no derived class, as for shapes,
``define`` returns a function that makes an instance from the properties.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.discovery import plugin_files
from brdfkit.core.discovery.plugin_files import KINDS, MODELS
from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.bsdf import adapter
from brdfkit.mitsuba_bridge.properties.conversions import require_known_properties
from brdfkit.model import Model, labels


def require_vectorised(plugin: str) -> None:
    """Raise `BrdfkitError` in scalar variants, for a `plugin` of this name that needs arrays."""
    import mitsuba as mi

    if str(mi.variant()).startswith("scalar"):
        raise BrdfkitError(
            f"{plugin} does not run in {mi.variant()}; set llvm_ad_rgb or cuda_ad_rgb."
        )


_registered: set[tuple[str, str, str]] = set()


def register_new_plugins() -> None:
    """Register the plugins that are not yet registered in Mitsuba's current variant, if it has one.

    Volumes are left out in scalar_rgb. Mitsuba 3.9 takes the kind of a plugin in all variants from
    its registration there, and refuses in dictionaries a volume that is registered as a texture.
    """
    import mitsuba as mi

    variant = mi.variant()
    if variant is None:
        return
    for kind, (_, register) in KINDS.items():
        if kind == "volumes" and variant == "scalar_rgb":
            continue
        for name in plugin_files.find_plugins(kind):
            if (variant, kind, name) not in _registered:
                _registered.add((variant, kind, name))
                getattr(mi, register)(name, lambda props, k=kind, n=name: _make_plugin(k, n, props))


def _make_plugin(kind: str, name: str, props: MitsubaObject) -> MitsubaObject:
    """Make an instance, in the current variant, of the class that the plugin's file defines now."""
    import mitsuba as mi

    source = plugin_files.find_plugins(kind)[name]
    model = labels.find_model_in(source) if kind == MODELS else None
    if model is None:
        module = plugin_files.import_plugin(source)
        made = _define_plugin(module, mi.variant())(props)
        known = getattr(module, "PARAMETERS", None)
    else:
        options = {option: props[option] for option in model.options if option in props}
        configured: Any = model.configured(**options)
        made = _define_plugin(configured, mi.variant())(props)
        known = [*model.parameters, *model.options]
    if known is not None:  # a plugin without PARAMETERS checks its properties by itself
        require_known_properties(props, name, known)
    return made


@cache
def _define_plugin(source: Any, _variant: str) -> Callable[[MitsubaObject], MitsubaObject]:
    """Return Mitsuba's class for a `Model`, or the result of the ``define(mi)`` of a module.

    Raises `BrdfkitError` where ``define`` raises an error or returns nothing to call.
    """
    import mitsuba as mi

    if isinstance(source, type) and issubclass(source, Model):
        return adapter.define_bsdf(mi, source)
    try:
        plugin_class = source.define(mi)
    except BrdfkitError:
        raise
    except Exception as error:
        raise BrdfkitError(
            f"{source.__file__}: define(mi) raises {type(error).__name__}: {error}."
        ) from error
    if not callable(plugin_class):
        raise BrdfkitError(
            f"{source.__file__}: define(mi) returns {plugin_class!r}; it should return the "
            "plugin's class."
        )
    return plugin_class
