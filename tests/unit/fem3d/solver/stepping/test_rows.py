"""Rows of forces: each is one node's and one piece's, and nothing else is added to it."""

from __future__ import annotations

import numpy as np

from impactlab.fem3d.solver.elements.hexahedron import W
from impactlab.fem3d.solver.mesh.mesh import brick
from impactlab.fem3d.solver.stepping.assembly import MOST_THREADS, _group, blocks_of, force_assembly

STEEL = (210e9, 0.3, 80e9, 175e9, 345e6, 0.0, 0.0)


def two_groups():
    """Of 11 and of 979 elements, all of one brick."""
    nodes, elements = brick(np.arange(11.0), np.arange(12.0), np.arange(10.0))
    numbers = np.split(np.arange(len(elements)), [11])
    groups = [
        _group(elements, which, whole, STEEL)
        for which, whole in zip(numbers, (True, False), strict=True)
    ]
    return len(nodes), groups


def test_every_corner_adds_to_a_row_of_its_node():
    nodes, groups = two_groups()
    rows = force_assembly(groups, nodes)
    owner = np.full(rows.count, -1)
    owner[rows.slots] = np.repeat(np.arange(nodes), np.diff(rows.starts))
    for group, own in zip(groups, rows.of_groups, strict=True):
        corners, found = (
            array.reshape(-1, 8, W).transpose(0, 2, 1).reshape(-1, 8)
            for array in (group.nodes, own)
        )
        count = group.elements.size
        np.testing.assert_array_equal(owner[found[:count]], corners[:count])
        assert np.all(owner[found[count:]] == -1)  # these fill the last block


def test_pieces_share_no_row():
    nodes, groups = two_groups()
    rows = force_assembly(groups, nodes)
    pieces = [
        set(own[slice(*blocks_of(group, piece, piece + 1))].ravel().tolist())
        for group, own in zip(groups, rows.of_groups, strict=True)
        for piece in range(MOST_THREADS)
    ]
    assert sum(map(len, pieces)) == len(set().union(*pieces)) == rows.count


def test_blocks_are_all_shared_out_in_their_order():
    _, (_, group) = two_groups()
    ends = [blocks_of(group, piece, piece + 1) for piece in range(MOST_THREADS)]
    assert ends[0][0] == 0
    assert ends[-1][1] == group.blocks
    assert [end for _, end in ends[:-1]] == [first for first, _ in ends[1:]]
    assert blocks_of(group, 0, MOST_THREADS) == (0, group.blocks)
