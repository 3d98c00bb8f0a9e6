"""The metal: J2 plasticity with linear hardening, stresses turning with the material.

Symmetric tensors are six numbers: xx, yy, zz, yz, zx, xy.
"""
