"""Compares the fits of a report, and writes its verdict: which fit to take, and why."""
