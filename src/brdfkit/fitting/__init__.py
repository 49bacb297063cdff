"""The verbs that are one file each: `fit` and what says more of one, `compare`, `convert` ..."""
