"""Make a robot folder from a URDF: the chain, the values of the URDF, and rules for what it lacks, each
marked as a guess.
"""
