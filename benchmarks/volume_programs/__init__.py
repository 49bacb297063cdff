"""Draws the conformance set of volumes in several programs; a file `by_NAME.py` is for one of them.

It defines NAME, `find_version()`, SETTINGS (descriptions of settings by name), and
`draw_case(case, setting)`. This returns RGB and opacity (height, width, 4) in linear numbers, NaN
in a channel that the program does not have, or None if it cannot draw the case. `case.py` reads a
case, and `page.py` and `figure.py` write the results to docs/volume_programs.md.
"""
