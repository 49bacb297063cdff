"""How certain a fit is: bootstrap, profiles, prediction errors, and the limit of isotropic
models.
"""
