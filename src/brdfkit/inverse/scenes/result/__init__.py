"""Makes the result of `refine`: values, standard errors, and notes about doubtful findings."""
