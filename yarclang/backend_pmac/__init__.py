"""Printing a plan as text for the Turbo PMAC.

This package only writes. The text is read back by certify, which shares no code with it.
"""
