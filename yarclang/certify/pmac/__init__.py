"""The judge's own reader of a text for a Turbo PMAC, and what only such a text must fulfil."""
