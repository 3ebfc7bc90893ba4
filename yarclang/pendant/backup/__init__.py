"""Backups of the project: writing a zip, judging one before it is unpacked, and listing what it would
change.
"""
