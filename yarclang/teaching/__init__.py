"""A program as a list of commands that is changed by small edits of its text: teaching, touching up, forms, templates."""
