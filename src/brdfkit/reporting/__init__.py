"""`report`: a measured material beside the models fitted to it, as one HTML file for any browser.

`report.py` does it step by step: the fits (`fits.py`), the pictures (`pictures/pictures.py`), what
they say as plain data (`contents.py`, of a file for each section), and the page
(`core/pages/page.py`), whose template, style and script are in `templates/`. `many_files.py` does
so for many files, with a page that leads to their reports.
"""
