"""The machines around a simulated robot, which change its inputs."""
