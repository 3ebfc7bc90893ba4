"""Motion programs, rotaries and PLCs: how they are stored, linked, and executed."""
