"""The corrected beam model beside 3-D finite elements, struck beside its middle and clamped.

python tests/benchmarks/places.py [ELEMENTS_PER_RADIUS ...]

Writes docs/agreement_places.csv. The 3-D runs, half an hour on two cores, are kept in
results/agreement. Reference and uncertainty are those of agreement.py: mean and half the range of
several meshes. Beside mid-span they are halves, of twice the cost.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace

import pandas as pd
from agreement import MODELS, RESPONSES, ROOT, UNCERTAINTY, differences, mean_solid

import impactlab as il

VELOCITY, DURATION = 5.0, 0.21e-3
"""In m/s and s: through the first contact."""
PLACES = (0.5, 0.375, 0.25)
"""Of the strike over the span."""
MESHES = (6.0, 6.5, 7.0)
"""Elements over the radius of the contact."""
SUPPORTS = ("pinned", "clamped")
COMPARED = ("the paper's model", "all but stress", "all")
"""Models of agreement.py."""


def impacts() -> Iterator[tuple[float, str, il.Impact]]:
    """Yield place of the strike, supports and the paper's model of each case."""
    paper = il.paper_impact(VELOCITY)
    for ends in SUPPORTS:
        beam = replace(paper.beam, support_left=ends, support_right=ends)
        for place in PLACES:
            yield place, ends, replace(paper, beam=beam, strike_position=place)


def main(meshes: Sequence[float]) -> None:
    """Solve and tabulate."""
    rows = []
    for place, ends, impact in impacts():
        case = f"{ends}, {place:g}, {VELOCITY:g}"
        witness, spread = mean_solid(impact, DURATION, meshes, case)
        labels = {"strike_position": place, "supports": ends}
        rows.append(labels | {"model": UNCERTAINTY} | spread)
        for model in COMPARED:
            ours = replace(impact, **MODELS[model])
            rows.append(labels | {"model": model} | differences(ours, witness))
    table = pd.DataFrame(rows)[["strike_position", "supports", "model", *RESPONSES]]
    table = table.round(dict.fromkeys(RESPONSES, 2))
    table.to_csv(ROOT / "docs" / "agreement_places.csv", index=False)
    print(table.to_string(index=False))


if __name__ == "__main__":
    main([float(elements) for elements in sys.argv[1:]] or MESHES)
