"""Messages of the pendant's API in addition to those of the coordinator. Each is a type with one JSON
form.
"""
