"""Printing a motion plan as text for the Turbo PMAC.

This package only writes such texts. The package certify, which shares no code with it, reads them back.
"""
