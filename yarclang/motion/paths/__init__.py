"""Define paths, with one module for each kind."""
