"""A program or a run in three dimensions: what is shown, as plain data, and who draws it in a browser."""
