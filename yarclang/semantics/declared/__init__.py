"""Declarations carried out."""
