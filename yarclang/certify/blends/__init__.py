"""Proofs of places where one motion flows into the next."""
