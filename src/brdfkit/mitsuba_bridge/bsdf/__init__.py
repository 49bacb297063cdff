"""Makes a Mitsuba BSDF of a model or of a measured table."""
