"""Figures for papers, from stored datasets: one record per figure, listed in `catalogue`.

`draw.draw_all` writes those that apply to a study. `style` is the look, `labels` the words,
`access` what datasets hold.
"""
