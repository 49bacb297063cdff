"""What `svbrdf` returns, and what it writes."""
