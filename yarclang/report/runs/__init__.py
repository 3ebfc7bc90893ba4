"""Runs: their logs, what they told, and pictures of them."""
