"""The language server `yarc lsp`, which supports editors by the Language Server Protocol.

It translates the results of yarclang.assist and of the compiler's stages to the protocol, and computes
nothing itself.
"""
