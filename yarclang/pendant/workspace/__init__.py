"""The workspace: display and changes of a cell's zones and obstacles, and of joint limits."""
