"""The losses that a fit minimises, and the measures over which they are means."""
