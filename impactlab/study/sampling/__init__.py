"""Sampling methods, one file each, and the designs that they draw.

A method's file holds its section of the study file, its draws and its `SamplingMethod`; `methods`
is the registry. The indices of a method are in the file of the same name in analysis.sensitivity.
"""
