"""The language server: `yarc lsp`. It translates what yarclang.assist and the pipeline know to the protocol, and knows nothing of its own."""
