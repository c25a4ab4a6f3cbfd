"""Sheets of claims: read, judged, reported."""
