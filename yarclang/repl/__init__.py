"""`yarc repl`: a person at the robot with a terminal. What is typed goes to a coordinator; nothing of the language or the robot is known here."""
