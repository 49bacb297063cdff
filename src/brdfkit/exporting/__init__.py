"""Writes fitted materials for other renderers, each as a fit to what that renderer can draw.

`export.py` is the verb. One file of `targets/` is one target: what it can hold, and how its file is
written. `target.py` describes what a target draws of a material, and `ggx_sum.py` the form that
most targets hold exactly. `hold.py` finds the nearest material that a target holds, and `loss.py`
measures what was lost. `filling.py` makes the texts of files from the `templates/`.
"""
