"""The machines around a simulated robot. They change its inputs."""
