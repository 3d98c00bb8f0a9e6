"""What a stored dataset holds, told in words and display units; for the figures and the report."""
