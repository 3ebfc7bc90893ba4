"""How a Turbo PMAC is talked to: looked at, streamed to, brought to rest."""
