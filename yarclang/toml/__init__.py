"""Read TOML files that users write: their text, the positions of keys and values, and findings about their
form.
"""
