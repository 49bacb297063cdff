"""`python -m brdfkit`: the command line, where the program `brdfkit` is not on the path."""

from brdfkit.cli import main

main(prog_name="python -m brdfkit")
