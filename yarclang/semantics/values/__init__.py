"""Expressions, units and numbers: mm and deg become m and rad here."""
