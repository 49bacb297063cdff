"""The verbs of fitting: `fit`, `compare`, and what ranks, repeats and doubts fits.

The numbers behind them, which know no `Measured`, are in `brdfkit.regression`.
"""
