"""Writes the report of a measured material: one HTML file that compares it with fitted models.

`report.py` defines the public function `report`. It fits the models (`fits.py`), renders pictures
(`pictures/`), compares the fits (`verdict/`), draws charts (`charts/`), describes parameters
(`parameters.py`) and the provenance (`origin.py`), and collects all of this as plain data
(`contents.py`) for the template `core/pages/templates/report.html`. `many_files.py` writes reports
of many files, and a page with links to them.
"""
