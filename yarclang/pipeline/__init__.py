"""The whole way from text to certified text: the only package that knows all stages."""
