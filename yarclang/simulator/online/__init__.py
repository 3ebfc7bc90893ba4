"""On-line commands (lines that a host sends to the controller), by subject.

`interpreter.py` executes a line (`line.py`) by the table of `commands.py`. `questions.py` answers lines that
only contain questions, `controls.py` executes control characters, and `background.py` executes the lines that
programs send. The commands are in `motors.py`, `systems.py`, `variables.py`, `buffers.py` and
`controller.py`. `surroundings.py` is the controller as commands see it.
"""
