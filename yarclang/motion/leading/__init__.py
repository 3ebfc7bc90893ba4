"""Where single motions lead from where the robot stands, each kind by its own module."""
