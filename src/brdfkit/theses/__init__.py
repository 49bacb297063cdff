"""Run the claims of a thesis again and write a page of them, with the function `reproduce`.

A folder here is a thesis and is found by itself. Its `__init__.py` has TITLE, INTRODUCTION, NEEDS
(the measured files) and PARTS, the names of its files in the order of the page. A part is one table
or figure. It has SECONDS, about how long it takes, and a function `check_claims(sources, report)`,
which returns a `Section` of `page.py` with its `Claim`s and calls `report(done, total)` as it goes
on.
"""

from pathlib import Path

from brdfkit.theses.claims import Claim as Claim
from brdfkit.theses.reproducing import Reproduction as Reproduction
from brdfkit.theses.reproducing import list_theses as list_theses
from brdfkit.theses.reproducing import reproduce as reproduce

# In the repository the theses' folders are beside `plugins/`; a wheel has copies of them here
__path__.append(str(Path(__file__).resolve().parents[3] / "theses"))
