"""What `refine` returns, and what it says of how certain the numbers are."""
