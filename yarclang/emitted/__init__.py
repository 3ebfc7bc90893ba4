"""The header of texts for all kinds of controllers: comments with their origin, and a seal."""
