"""Talking to a controller."""
