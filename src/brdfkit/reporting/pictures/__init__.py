"""The pictures of a report, and their errors."""
