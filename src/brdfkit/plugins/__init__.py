"""Finds the plugins: one file is one plugin, in the top folder `plugins/` or of a user's.

The wheel copies that folder in here; a checkout is served by extending the path.
"""

from pathlib import Path

__path__.append(str(Path(__file__).resolve().parents[3] / "plugins"))
