"""Colours for programs in documentation and terminals: a Pygments lexer, and the words of the language by
kind.
"""
