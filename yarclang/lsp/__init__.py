"""The language server `yarc lsp`.

It translates the results of yarclang.assist and of the pipeline to the protocol, and computes nothing itself.
"""
