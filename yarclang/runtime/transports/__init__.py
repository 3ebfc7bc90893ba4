"""Ways to a controller, one file a kind of address; and the socket by which other terminals reach a run."""
