"""Environment maps that are filtered once and then looked up, in place of paths."""
