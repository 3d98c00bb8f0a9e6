"""Hexahedra: what forces they answer a motion with.

Nodal values (8,) of an element are taken apart into modes: with xi, eta, zeta in -1 to 1,

    u = u_0 + c_1 xi + c_2 eta + c_3 zeta
        + g_1 eta zeta + g_2 zeta xi + g_3 xi eta + g_4 xi eta zeta,

c_k and g_k an eighth of the sums of nodal values times the signs of xi ... xi eta zeta there. In
this package c_k and g_k are those of the position x (m), w_k and h_k those of the velocity (m/s).
"""
