"""Logs of runs: their list and their content."""
