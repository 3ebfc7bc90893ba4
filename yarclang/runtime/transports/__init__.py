"""Connections to a controller, and the local socket by which other terminals reach a run."""
