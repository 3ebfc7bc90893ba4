"""Read TOML files that users write: text, positions of keys and values, and findings about their form."""
