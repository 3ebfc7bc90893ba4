"""Proofs of single motions: limits, paths, speeds."""
