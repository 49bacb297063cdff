"""Closed forms of the probabilities P̂(i) of blocks, the largest block first: no table, no search.

A law is a frozen dataclass of numbers, fitted to the blocks' shares of the power, which fall, by
`fit(shares)`. It has P̂ as `probability(i)`, F as `cumulative(x)` and F⁻¹ as `inverse(xi)`, which
compute by the functions of its module `maths`: NumPy's, or Dr.Jit's in the renderer
(`sorted_blocks.py`). An estimate by any law is unbiased, as P̂ and not the share divides it.
"""
