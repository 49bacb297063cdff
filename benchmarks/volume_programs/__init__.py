"""The conformance set in several programs: one file is one program, which draws a case.

Each has NAME, `version()`, SETTINGS (what is set: name → words), and `picture(case, setting)`: RGB
and opacity (height, width, 4) in linear numbers, NaN where the program has no such channel; None
where it cannot draw the case. `case.py` is a case.
"""
