"""Transfer functions: values to colour and opacity, their files, presets and lookups."""
