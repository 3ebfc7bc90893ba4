"""Bounds of what a header may ask of whoever reads it."""

MOST_SEARCHES = 64
"""No more ways round are looked for to take the quickest: whoever judges a text with its program looks for them again."""
