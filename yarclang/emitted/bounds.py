"""Bounds of the values in a header. They keep the work of a reader finite."""

MOST_SEARCHES = 64
"""Largest number of searches for a path around obstacles. If the judge has the program, it repeats as many
searches as the header states.
"""
