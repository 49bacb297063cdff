"""Renders distance fields within Mitsuba: the parts of the integrator `distance_field`."""
