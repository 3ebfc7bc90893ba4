"""Bounds on the values in the header of a controller text. They limit the work of a program that reads the
header.
"""

MOST_SEARCHES = 64
"""Largest number of searches for a path around obstacles that a header may state. If the judge has the
program, it repeats as many searches as the header states.
"""
