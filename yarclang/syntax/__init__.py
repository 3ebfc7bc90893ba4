"""Convert text to a syntax tree and back. This package knows no command of the language."""
