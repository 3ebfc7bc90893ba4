"""One file a profile; `yarclang.motion.profile` finds them."""
