"""Recognise common mistakes in lines that can't be read, and answer each line with one finding and its
repair.
"""
