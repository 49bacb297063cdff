"""Pictures of distance fields within Mitsuba: what the integrator `distance_field` is made of.

`seen_point.py`: where camera rays meet the field; `parts.py`: the BSDF there; `lamps.py`: the
lights of a scene; `direct_light.py`: what light arrives; `exposed.py`: what an optimiser
changes.
"""
