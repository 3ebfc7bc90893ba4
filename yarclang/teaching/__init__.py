"""Small edits of a program that is shown as a list of commands: teaching, touching up, forms, templates."""
