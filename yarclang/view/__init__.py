"""Show programs and runs in three dimensions: the contents as plain data, and their display in a browser."""
