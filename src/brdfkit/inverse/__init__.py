"""Finds numbers from pictures: of whole scenes by `refine`, of flat samples by `svbrdf`."""
