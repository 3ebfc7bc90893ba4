"""Motion commands: goals, times, options, and the primitives that they become."""
