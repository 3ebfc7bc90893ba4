"""Bounds of the values in a header, which keep a reader's work finite."""

MOST_SEARCHES = 64
"""Most searches for a way round obstacles. A judge with the program repeats as many as the header names."""
