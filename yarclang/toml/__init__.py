"""TOML files that people write: their text, the places of their keys and values, and the findings about their form."""
