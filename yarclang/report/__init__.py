"""Output for people: texts on robots, programs and runs, and pictures of motions."""
