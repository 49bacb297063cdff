"""Registers the plugins in Mitsuba when it is imported, and loads users' plugins."""
