"""How a block is chosen: laws of the probabilities P̂(i) of blocks, the largest block first.

A law is fitted to the blocks' shares of the power, by `fit(shares)`, which fall. It has P̂ as
`probability(i)`, F as `cumulative(x)` and F⁻¹ as `inverse(xi)`, of NumPy's arrays; and
`in_renderer()` is what chooses by it in Mitsuba's current variant: `choose(u, active)` → (block,
what is left of the uniform number u, P̂). An estimate by any law is unbiased, as P̂ and not the
share divides it.
"""
