"""The header of controller texts, the compiler's output for all kinds of controllers: comments about the
text's origin, and a seal.
"""
