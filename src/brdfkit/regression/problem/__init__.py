"""The error of a model on samples or on pixels, with its derivatives."""
