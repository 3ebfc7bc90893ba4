"""Simulation of the machines around a simulated robot. They change the controller's inputs."""
