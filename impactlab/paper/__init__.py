"""The source paper: its figures drawn anew and its statements put to the test."""
