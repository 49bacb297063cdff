"""Cases whose times docs/tools/make_performance.py measures, and how it measures them.

A case is a function that prepares something and returns what is timed: a function without
arguments. Cases are in `fits.py`, `pictures.py`, `growth.py` and `traffic.py`, by their names in
`CASES`. `timing_process.py` runs them in a process of its own, so that the sources of two versions
of brdfkit can take turns; `measuring.py` starts such processes. Cases use only what both versions
have. `rows.py` lists what the page shows.
"""
