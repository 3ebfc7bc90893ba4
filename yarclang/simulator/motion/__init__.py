"""How motors move: cubics in time, blended moves, jogs, the time base, limits."""
