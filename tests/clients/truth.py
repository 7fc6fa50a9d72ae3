"""Rows of the same joint at indentations that no table holds; what every client is compared with."""

import csv

#: Asked of the interpolation; the rows themselves are far better.
ERROR = 1e-3


def rows():
    """Indentation (mm), force (N) and stiffness (N/mm)."""
    with open("truth/table.csv") as file:
        found = [
            (float(r["indentation_mm"]), float(r["force_n"]), float(r["tangent_stiffness_n_per_mm"]))
            for r in csv.DictReader(file)
        ]
    assert len(found) == 500
    return found


def check(name, force, above=0.0):
    """Worst relative deviation of force(indentation_mm) from the rows above some indentation."""
    worst = 0.0
    asked = [(x, truth) for x, truth, _ in rows() if x >= above]
    for x, truth in asked:
        off = abs(force(x) / truth - 1.0)
        worst = max(worst, off if off == off else float("inf"))
    print(f"{name}: within {100 * worst:.3g} % at {len(asked)} unseen indentations")
    assert len(asked) > 100 and worst < ERROR, worst
