"""What people look at: a robot as text, a motion as a picture."""
