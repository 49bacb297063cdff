"""Tests the claims of a thesis by the function `reproduce`, and writes a page with the results.

To add a thesis, add a folder for it. Its `__init__.py` defines TITLE, INTRODUCTION, NEEDS (the
measured files) and PARTS, the names of its other files in the order of the page. Such a file tests
one table or figure. It defines SECONDS, about how long it takes, and the function
`check_claims(sources, report)`, which returns a `Section` of `page.py` with its `Claim`s and calls
`report(done, total)` to show its progress.
"""

from pathlib import Path

from brdfkit.theses.claims import Claim as Claim
from brdfkit.theses.reproducing import Reproduction as Reproduction
from brdfkit.theses.reproducing import list_theses as list_theses
from brdfkit.theses.reproducing import reproduce as reproduce

# The theses' folders are beside `plugins/` in the repository, and in this package in a wheel
__path__.append(str(Path(__file__).resolve().parents[3] / "theses"))
