"""Limits on the segment time that the controller stores (TSRM 463, 476; TUM 292)."""

QUANTUM = 1e-3 / 4096.0
"""Resolution of TM [s]: a fixed-point number with 12 fraction bits of a millisecond."""

LARGEST = 4096e-3
"""Largest TM [s]. A longer one is clipped, and the motion would run faster than requested."""
