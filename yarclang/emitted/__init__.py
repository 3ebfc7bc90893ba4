"""The header of controller texts of all kinds: comments about their origin, and a seal."""
