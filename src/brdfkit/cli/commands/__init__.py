"""The commands of the command line: each file NAME.py holds the click command NAME.

No list names the commands. A file also holds the functions that print the command's result. It
imports slow modules only when the command runs, so that `--help` appears at once. Code that several
commands share lies in the folder above.
"""
