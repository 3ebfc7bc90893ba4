"""The machines around a simulated robot: what they do with its inputs, when."""
