"""What the controller keeps of a segment time (TSRM 463, 476; TUM 292)."""

QUANTUM = 1e-3 / 4096.0
"""TM is fixed-point with 12 fraction bits of a millisecond: one step [s]."""

LARGEST = 4096e-3
"""A longer TM is clipped: the motion would run faster than asked [s]."""
