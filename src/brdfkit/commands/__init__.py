"""The commands: one file is one command, found by its being there.

A file NAME.py holds the click command NAME, and the functions that print its result. It imports
what is heavy when a command runs, so that `--help` is instant. A module whose name begins with an
underscore is no command: it holds what several share.
"""
