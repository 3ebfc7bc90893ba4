"""Define profiles, one in each file; `yarclang.motion.profile` finds them."""
