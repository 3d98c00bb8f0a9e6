"""Figures of one 3-D run: plot(solid, beams) -> Figure each; `drawings` writes them.

solid: a dataset of fem3d.solver. beams: the beam models' answers to the same impact, on
`beam_model`.
"""
