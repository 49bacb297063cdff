"""Registers the plugins in Mitsuba: every kind, in every variant, each built when first used.

A plugin file holds either a `Model`, or a function ``define(mi)`` that returns a class derived from
one of Mitsuba's for the current variant. Where Mitsuba allows no derived class, as for shapes,
``define`` returns a function that makes an instance from the properties.
"""

from functools import cache

from brdfkit.core.discovery import plugin_files
from brdfkit.core.discovery.plugin_files import KINDS, MODELS
from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.bsdf import adapter
from brdfkit.mitsuba_bridge.properties.conversions import require_known
from brdfkit.model import Model, labels


def require_vectorised(plugin):
    """Raise `BrdfkitError` in scalar variants, for a `plugin` of this name that needs arrays."""
    import mitsuba as mi

    if mi.variant().startswith("scalar"):
        raise BrdfkitError(
            f"{plugin} does not run in {mi.variant()}; set llvm_ad_rgb or cuda_ad_rgb."
        )


_registered: set[tuple[str, str, str]] = set()


def register_all():
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


def _make_plugin(kind, name, props):
    """An instance, in the current variant, of the class that the plugin's file defines now."""
    import mitsuba as mi

    source = plugin_files.find_plugins(kind)[name]
    model = labels.find_model_in(source) if kind == MODELS else None
    if model is None:
        module = plugin_files.import_plugin(source)
        made, known = (
            _define_plugin(module, mi.variant())(props),
            getattr(module, "PARAMETERS", None),
        )
    else:
        options = {option: props[option] for option in model.options if option in props}
        made = _define_plugin(model.configured(**options), mi.variant())(props)
        known = [*model.parameters, *model.options]
    if known is not None:  # else the plugin reads its properties by itself
        require_known(props, name, known)
    return made


@cache
def _define_plugin(source, _variant):
    """Mitsuba's class for a `Model`, or what the ``define(mi)`` of a module returns.

    Raises `BrdfkitError` where a module's ``define`` raises an error or returns nothing to call.
    """
    import mitsuba as mi

    if isinstance(source, type) and issubclass(source, Model):
        return adapter.define_bsdf(mi, source)
    try:
        found = source.define(mi)
    except BrdfkitError:
        raise
    except Exception as error:
        raise BrdfkitError(
            f"{source.__file__}: define(mi) raises {type(error).__name__}: {error}."
        ) from error
    if not callable(found):
        raise BrdfkitError(
            f"{source.__file__}: define(mi) returns {found!r}; it should return the plugin's class."
        )
    return found
