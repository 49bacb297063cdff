"""Robust fits, which reduce the weight of outliers and search again, until both agree."""
