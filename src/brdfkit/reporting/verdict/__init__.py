"""The sentences at the head of a report: which fit to take, and why."""
