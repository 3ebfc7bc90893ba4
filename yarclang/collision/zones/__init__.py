"""Zones of a cell: what they watch, how far that is from their borders, and whether it stays so along a motion."""
