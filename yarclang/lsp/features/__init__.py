"""The features of the language server, one in each file. Each translates one kind of result of
yarclang.assist or of the compiler's stages.
"""
