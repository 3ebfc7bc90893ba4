"""One file a command; `yarclang.commands.registry` finds them."""
