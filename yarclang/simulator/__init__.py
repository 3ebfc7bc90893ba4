"""A Turbo PMAC without hardware: its commands, programs and motions in virtual time."""
