"""Makes the result of `svbrdf`: maps, standard errors, notes, files and a report."""
