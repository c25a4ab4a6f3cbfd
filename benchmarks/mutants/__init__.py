"""Mutation testing of canon: changes of its code, the tests that execute what is changed, and a trial of each."""
