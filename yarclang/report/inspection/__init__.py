"""All that is known of one command: `yarc inspect`."""
