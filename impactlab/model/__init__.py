"""What is struck, by what, how fast, and how finely it is cut: frozen, SI, checked when made."""
