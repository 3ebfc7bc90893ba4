"""Output for people: texts about robots, programs and runs, and pictures of motions."""
