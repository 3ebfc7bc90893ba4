"""One file for each word; `yarclang.words.registry` finds them."""
