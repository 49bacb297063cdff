"""Runs the command line as `python -m brdfkit`, where the program `brdfkit` is not on the PATH."""

from brdfkit.cli import main

main(prog_name="python -m brdfkit")
