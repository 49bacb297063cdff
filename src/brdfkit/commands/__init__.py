"""The commands: one file of this folder each; `brdfkit.cli` finds them by their being there.

A file NAME.py holds the click command NAME, and the functions that print its result. It imports
what is heavy when a command runs, so that `--help` is instant. A module whose name begins with an
underscore is no command: it holds what several share.
"""
