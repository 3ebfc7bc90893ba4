"""Plan motions that flow into each other: blended corners, and chains of motions without a stop."""
