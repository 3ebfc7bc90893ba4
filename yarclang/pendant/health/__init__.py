"""Health of the pendant's computer, its process and its data."""
