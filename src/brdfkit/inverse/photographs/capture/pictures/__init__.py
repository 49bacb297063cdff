"""Reads photographs of any format as linear values, and masks; a photograph at a time."""
