"""Work on many cores and machines, reuse of results, and searches that need many programs."""
