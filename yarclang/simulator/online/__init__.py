"""On-line commands, by subject.

`interpreter.py` executes a line (`line.py`) by the table of `commands.py`. `questions.py` answers lines that
only contain questions, `controls.py` executes control characters, and `background.py` executes the lines of
programs. The commands are in `motors.py`, `systems.py`, `variables.py`, `buffers.py` and `controller.py`.
`surroundings.py` is the controller as commands see it.
"""
