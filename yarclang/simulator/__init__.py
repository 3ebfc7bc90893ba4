"""A Turbo PMAC without hardware: its commands, programs and motions in virtual time.

`machine.py` is the controller. Other modules access the controller through protocol classes: `language/`
reads its language, `online/` executes on-line commands, `programs/` executes motion programs and PLCs,
`motion/` moves the motors, and `state/` holds variables, registers and status words. `network/` serves it.
`commissioning.py` sets it up as a robot's controller, `faults.py` injects faults, and `beside.py` connects
the machines around the robot.
"""
