"""Recognise common mistakes in program lines that can't be read: one finding for each line, with its
repair.
"""
