"""The rules; each file has a RULE. None imports another."""
