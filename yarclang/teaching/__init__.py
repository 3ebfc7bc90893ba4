"""Small edits of a program seen as a list of commands: teaching, touching up, forms, templates."""
