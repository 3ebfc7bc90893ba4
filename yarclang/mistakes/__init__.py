"""What people write instead of the language, and what they mean by it: one answer for a line, in its place, with its repair."""
