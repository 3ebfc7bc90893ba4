"""Make a robot folder from a URDF: the chain, the values of the URDF, and rules for missing values, each
marked as a guess.
"""
