"""Define profiles, with one module for each; `yarclang.motion.profile` finds them."""
