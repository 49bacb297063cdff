"""What exists only inside Mitsuba: models and tables as its plugins, in each of its variants.

`hook.py` registers the plugins when Mitsuba is imported (`registration.py`), a `Model` through
`bsdf.py`. `frame.py` is the base class of all of brdfkit's BSDF plugins. `declared.py` is how a
plugin of another kind declares its parameters. `channels.py` makes spectra of a variant's type from
colours and wavelengths.
"""
