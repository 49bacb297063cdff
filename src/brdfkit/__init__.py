"""brdfkit: any measured material becomes a validated, importance-sampled Mitsuba material.

>>> import brdfkit as bk
>>> paint = bk.load("car_paint")    # a file, or a material that comes along    # doctest: +SKIP
>>> bk.audit(paint)  # what was measured, and what is doubtful    # doctest: +SKIP
>>> fits = [bk.fit(paint, name) for name in ("ward", "ggx")]    # doctest: +SKIP
>>> bk.compare(paint, fits)    # errors; bk.rank chooses among all bk.models()    # doctest: +SKIP
>>> bk.render([paint, *fits]).write("paint.exr")    # doctest: +SKIP
>>> bk.report(paint, fits, path="paint.html")    # all of it on one page    # doctest: +SKIP

Importing brdfkit is fast and sets no Mitsuba variant. It makes the models known to Mitsuba as BSDF
plugins in every variant, and chooses the LLVM that Dr.Jit loads (`brdfkit.core.jit.llvm`).
"""

import lazy_loader

from brdfkit.core.jit import llvm
from brdfkit.core.version import __version__ as __version__
from brdfkit.mitsuba_bridge.registration import hook

# Only __init__.pyi lists the public names; each is imported when it is first used
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

llvm.choose_llvm_library()
hook.install_import_hook()
