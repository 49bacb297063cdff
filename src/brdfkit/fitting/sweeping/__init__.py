"""`sweep`: models fitted to many materials, by several processes or on a cluster.

`planning.py` makes tasks of files, models and settings; `tasks.py` does a task, a pure function of
plain data. `processes.py` and `cluster.py` run tasks, here and elsewhere; `saved_fits.py` keeps
what is finished. `result.py` is what comes out, as text and tables; `page.py` its page.
"""

from brdfkit.fitting.sweeping.result import Row as Row
from brdfkit.fitting.sweeping.result import Sweep as Sweep
from brdfkit.fitting.sweeping.sweeping import sweep as sweep
