"""Where elements leave their nodal forces: a row a node and piece of a group.

Two threads never add to one row, and the order of all sums is the mesh's: a group is cut into the
same pieces for any number of threads.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from impactlab.fem3d.solver.elements.lanes import W
from impactlab.fem3d.solver.mesh.mesh import Integers
from impactlab.fem3d.solver.stepping.groups import Group
from impactlab.fem3d.solver.types import Array

MOST_THREADS = 24
"""Pieces of a group: it is shared equally by 2, 3, 4, 6, 8 or 12 threads, too."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Rows of forces, (count, 3).

    of_groups: like Group.nodes, the rows in place of the nodes. starts: (n + 1,);
    slots[starts[i]:starts[i + 1]]: the rows of node i.
    """

    of_groups: list[Array]
    starts: Integers
    slots: Integers
    count: int


def blocks_of(group: Group, first: int, end: int) -> tuple[int, int]:
    """The blocks of a group's pieces from the first to before the one named by `end`."""
    return group.blocks * first // MOST_THREADS, group.blocks * end // MOST_THREADS


def force_rows(groups: Sequence[Group], nodes: int) -> Rows:
    """Rows for the elements of all groups, on that many nodes."""
    of_groups, owners = [], []
    count = 0
    for group in groups:
        rows = np.empty_like(group.nodes)
        for piece in range(MOST_THREADS):
            blocks = slice(*blocks_of(group, piece, piece + 1))
            own, place = np.unique(group.nodes[blocks], return_inverse=True)
            rows[blocks] = count + place.reshape(rows[blocks].shape)
            owners.append(own)
            count += own.size
        spare = len(group.nodes) * W - group.elements.size
        rows.reshape(-1, 8, W)[-1, :, W - spare :] = count  # what fills the last block adds nothing
        owners.append(np.array([nodes]))
        count += 1
        of_groups.append(rows)
    every = np.concatenate(owners)
    starts = np.concatenate([[0], np.cumsum(np.bincount(every, minlength=nodes)[:nodes])])
    slots = np.argsort(every, kind="stable")[: starts[-1]]
    return Rows(of_groups, starts.astype(np.int32), slots.astype(np.int32), count)
