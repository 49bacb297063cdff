"""`Plot`, a figure of matplotlib without pyplot, which notebooks show."""

from matplotlib.figure import Figure

from brdfkit.core.figures import to_png


class Plot(Figure):
    """A matplotlib `Figure` that is not pyplot's: no window, no global state.

    Notebooks show it, also where pyplot has not told them how.
    """

    def _repr_png_(self):
        return to_png(self)
