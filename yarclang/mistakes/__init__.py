"""Recognise common mistakes in lines that can't be read: one finding for each line, with its repair."""
