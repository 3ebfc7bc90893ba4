"""Complete information on one command: `yarc inspect`."""
