"""The 3-D finite-element model of the impact: solver, decks, Kratos, studies, figures, report.

A wing: the core never imports it, and reads in wing.py what it adds.
"""
