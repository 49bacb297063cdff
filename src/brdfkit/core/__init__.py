"""Tools on which all of brdfkit rests and that know nothing of BRDFs: errors, files, geometry,
pages.
"""
