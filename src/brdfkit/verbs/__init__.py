"""The verbs that are one file each: `fit`, `compare`, `convert`, `evaluate` and `albedo`."""
