"""Compares the fits of a report, and puts into words which one to take and why."""
