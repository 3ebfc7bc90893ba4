"""Syntax tree to checked program: names, frames, units, values, flow."""
