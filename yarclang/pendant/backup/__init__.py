"""Backups of the project: a zip that is written, one that is judged before anything of it is unpacked, and what it changes."""
