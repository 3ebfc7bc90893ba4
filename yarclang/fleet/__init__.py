"""Work on many cores and machines, reused results, and findings that need many programs."""
