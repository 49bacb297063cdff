"""What exists only inside Mitsuba: models and tables as its plugins, in each of its variants.

`hook.py` registers the plugins when Mitsuba is imported (`registration.py`), a `Model` through
`bsdf.py`. `frame.py` is what all of brdfkit's BSDF plugins share, `declared.py` how a plugin of
another kind declares its parameters, `channels.py` how a colour becomes what a variant computes in.
"""
