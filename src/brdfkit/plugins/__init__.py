"""The plugins: one file is one plugin, in the top folder `plugins/` or added by a user.

The wheel contains a copy of the top folder here; in a checkout this package's path is extended by
the top folder.
"""

from pathlib import Path

__path__.append(str(Path(__file__).resolve().parents[3] / "plugins"))
