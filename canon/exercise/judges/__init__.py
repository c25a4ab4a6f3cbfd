"""The kinds of claims, one module a subject: from a claim that was read to the questions it comes down to."""
