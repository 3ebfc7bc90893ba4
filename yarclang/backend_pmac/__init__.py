"""Printing a plan as text for the Turbo PMAC.

This package only writes. The room certify, which shares no code with it, reads the text back.
"""
