"""Plan to Turbo PMAC text. It only writes: what reads the text back is certify, which shares no code with this."""
