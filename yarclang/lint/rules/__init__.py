"""The rules: each file has a RULE, and none imports another."""
