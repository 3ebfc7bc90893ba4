"""The dot commands by subject. Each module has `COMMANDS`; dot.py finds them."""
