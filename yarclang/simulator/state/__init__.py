"""Variables, registers and status words of the simulated controller."""
