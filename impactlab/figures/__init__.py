"""Figures for papers, from stored datasets: one figure a file, listed in `catalogue`.

`draw.draw_all` writes those that apply to a study; `style` is the look, `reading` the words.
"""
