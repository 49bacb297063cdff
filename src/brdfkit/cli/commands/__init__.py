"""The commands of the command line: one file is one command; no list names them.

A file NAME.py holds the click command NAME, and the functions that print its result. It imports
heavy modules only when the command runs, so that `--help` is instant. What several commands share
lies beside this folder.
"""
