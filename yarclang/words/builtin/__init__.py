"""One file a word; `yarclang.words.registry` finds them."""
