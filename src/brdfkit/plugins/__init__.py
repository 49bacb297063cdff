"""The plugins: one file, one plugin. They lie in the project's top folder `plugins/`, by kind.

The wheel copies that folder in here; a checkout is served by extending the path.
"""

from pathlib import Path

__path__.append(str(Path(__file__).resolve().parents[3] / "plugins"))
