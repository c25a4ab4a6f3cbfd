"""The ready systems as data, one module a subject."""
