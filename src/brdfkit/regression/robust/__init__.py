"""Fits models robustly: passes reduce the weight of outliers and search again."""
