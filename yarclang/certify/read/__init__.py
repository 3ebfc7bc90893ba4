"""Reads a controller text: header, lines, numbers, and the segments that they make."""
