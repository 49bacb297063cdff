"""Makes brdfkit's models, measured tables and other plugins known to Mitsuba, in each variant.

`registration/` registers the plugins when Mitsuba is imported. `bsdf/adapter.py` makes a BSDF
plugin of a `Model`, and `bsdf/base.py` is the base class of all of brdfkit's BSDF plugins. Plugins
of other kinds declare their parameters by `properties/declarations.py`. `channels.py` converts
colours and values at wavelengths to spectra of a variant's type.
"""
