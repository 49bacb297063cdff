"""The code that exists only inside Mitsuba: models and tables as its plugins, in each variant.

`registration/hook.py` registers the plugins when Mitsuba is imported
(`registration/registering.py`), a `Model` through `bsdf/adapter.py`. `bsdf/base.py` is the base
class of all of brdfkit's BSDF plugins. A plugin of another kind declares its parameters by
`properties/declarations.py`. `channels.py` makes spectra of a variant's type from colours and
wavelengths.
"""
