"""Follow the workpieces that grippers take and put down: compute their places at every instant of a
program.
"""
