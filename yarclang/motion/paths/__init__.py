"""Define paths, one kind in each file."""
