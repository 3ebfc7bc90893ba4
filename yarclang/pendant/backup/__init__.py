"""Backups of the project: writing a backup as a zip, checking an uploaded zip before it is unpacked, and
listing the changes that its restore would make.
"""
