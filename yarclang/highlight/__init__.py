"""Colours for programs in documentation and terminals: a lexer for Pygments, and the words of the language by their kinds."""
