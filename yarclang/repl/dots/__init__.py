"""The dot commands, by what they are about. Each module has `COMMANDS`; dot.py finds them."""
