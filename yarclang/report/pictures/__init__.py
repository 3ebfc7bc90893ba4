"""Draw pictures of plans."""
