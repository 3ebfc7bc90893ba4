"""Lint rules: rules about programs that compile, one file each in `rules`."""
