"""What the texts for all kinds of controllers begin with: comments that say what they were made of, and a seal."""
