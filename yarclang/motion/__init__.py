"""Checked program to motion plan: paths, laws of motion, and the curve that the controller executes."""
