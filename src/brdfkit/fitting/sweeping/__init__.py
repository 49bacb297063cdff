"""`sweep`: fits several models to many materials, in several processes or on a cluster.

`planning.py` makes tasks from files, models and settings, and `tasks.py` carries out one task.
`processes.py` runs tasks on this machine, `core/cluster.py` on a cluster. `judging.py` computes
held-out errors, `saved_fits.py` stores the finished fits in a folder, and `result.py` defines
the result, which `tables.py` and `page.py` write.
"""

from brdfkit.fitting.sweeping.result import Row as Row
from brdfkit.fitting.sweeping.result import Sweep as Sweep
from brdfkit.fitting.sweeping.sweeping import sweep as sweep
