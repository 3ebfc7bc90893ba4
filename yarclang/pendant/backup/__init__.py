"""Backups of the project: writing a zip, checking a zip before it is unpacked, and listing the changes that a
restore would make.
"""
