"""One file for each command; `yarclang.commands.registry` finds them."""
