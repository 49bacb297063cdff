"""The commands of the command line: one file is one command; no list names them.

A file NAME.py holds the click command NAME, and the functions that print its result. It imports
heavy modules only when the command runs, so that `--help` is instant. A file whose name begins with
an underscore is no command: it holds what several commands share.
"""
