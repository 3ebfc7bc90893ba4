"""Runs: their logs, reports, and pictures."""
