"""Collect complete information about one command, for `yarc inspect`."""
