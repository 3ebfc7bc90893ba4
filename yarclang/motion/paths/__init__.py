"""One file a kind of path."""
