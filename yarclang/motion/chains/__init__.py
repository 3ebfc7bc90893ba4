"""Let motions flow into each other: corners, and chains of motions without a stop."""
