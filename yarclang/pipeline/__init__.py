"""The whole way from text to certified text: the only place that knows all stages."""
