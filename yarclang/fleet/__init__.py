"""The same work on many cores and machines, results that are reused, and what only many programs show."""
