"""On-line commands, by what they are about; `commands.py` has the table of their forms."""
