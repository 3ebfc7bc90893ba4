"""Meanings of names: commands, frames, signals, and scopes."""
