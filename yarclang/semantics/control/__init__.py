"""Loops, conditions and calls, carried out to a flat list of steps."""
