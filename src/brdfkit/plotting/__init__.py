"""`plot`: the lobes of BRDFs, with matplotlib; the half disc of incidences for audits."""

from brdfkit.plotting.lobe_plots import Plot as Plot
from brdfkit.plotting.lobe_plots import plot as plot
