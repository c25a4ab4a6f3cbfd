"""Answers as they are typed: what people write in one field, made into what the keys of a claim hold."""
