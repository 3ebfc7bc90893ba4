"""Backups of the project. A backup is written as a zip. An uploaded zip is checked before it is unpacked, and
the changes that its restore would make are listed.
"""
