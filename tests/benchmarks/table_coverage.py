"""Coverage of the intervals of first orders of tables, measured over 200 seeds."""

import numpy as np
from functions import g, ishigami

import impactlab as il
from impactlab.methods import INDICES
from impactlab.methods.delta import first_orders
from impactlab.methods.runs import Sample

SEEDS, QUANTILE = 200, 1.959964
COVARIANCE = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.8], [0.0, 0.8, 1.0]])


def line(weights):
    """Return a line over normal inputs and its first orders, squares of covariances."""
    shares = (COVARIANCE @ weights) ** 2 / (weights @ COVARIANCE @ weights)

    def draw(rng, rows):
        inputs = rng.multivariate_normal(np.zeros(3), COVARIANCE, rows)
        return inputs, inputs @ weights

    return draw, shares


def of_cube(case):
    """Return draws of a function of the unit cube and its first orders."""

    def draw(rng, rows):
        inputs = rng.random((rows, len(case.groups)))
        return inputs, case.function(inputs)

    return draw, np.array(case.exact()["first_order"])


def factorial(rng, rows):
    side = round(rows**0.5)
    x = np.indices((side, side)).reshape(2, -1).T.astype(float)
    return x, x @ [1.0, 2.0]


def noise(rng, rows):
    x = np.column_stack([rng.integers(5, size=rows), rng.random(rows)]).astype(float)
    return x, x[:, 0] / np.sqrt(2) + rng.standard_normal(rows)


CASES = {
    "line": line(np.array([1.0, 1.0, 0.5])),
    "unused": line(np.array([1.0, 1.0, 0.0])),
    "ishigami": of_cube(ishigami("x0", "x1", "x2")),
    "g": of_cube(g(0.0, 1.0, 4.5, 9.0, 99.0, 99.0)),
    "factorial": (factorial, np.array([0.2, 0.8])),
    "noise": (noise, np.array([0.5, 0.0])),
}


def main():
    for name, (draw, exact) in CASES.items():
        for rows in (64, 256, 1024):
            held = np.zeros((2, len(exact)))
            for seed in range(SEEDS):
                inputs, outputs = draw(np.random.default_rng(seed + 1), rows)
                columns = {f"x{i}": column for i, column in enumerate(inputs.T)}
                runs = il.runs_of_table(columns, {"y": outputs}, indices="rbd_fast", seed=seed)
                sample, values = Sample.of(runs), runs["y"].values
                ranks, errors = first_orders(sample.inputs, values)
                waves = INDICES["rbd_fast"].estimate(values, sample, "y")
                held[0] += np.abs(ranks - exact) <= QUANTILE * errors
                held[1] += np.abs(waves["first_order"] - exact) <= waves["first_order_interval"]
            print(name, rows, *(100 * held / SEEDS).round())


if __name__ == "__main__":
    main()
