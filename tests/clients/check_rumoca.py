"""The package compiles; a ramp of the indentation gives the forces and stiffnesses of the curve."""

import os

import rumoca

from truth import check, rows

session = rumoca.Session()
example = session.load("joint.mo", model="joint.Example")
# First touch comes after 2 ms; what is in between is free flight.
swing = example.simulate(t=(0, 0.01), dt=1e-5)
assert max(swing["x"]) > 0.02e-3, max(swing["x"])
assert min(swing["v"]) < 0.0, "no rebound"

PROBE = """
  model Probe
    Real x(start=0, fixed=true);
    Real f;
    Real k;
  equation
    der(x) = 3e-5;
    f = force(x);
    k = stiffness(x);
  end Probe;
end joint;
"""
with open("joint.mo") as file:
    text = file.read()
# A folder of its own: the session reads all packages beside a file.
os.makedirs("probe", exist_ok=True)
with open("probe/joint.mo", "w") as file:
    file.write(text.replace("end joint;\n", PROBE))
probe = rumoca.Session().load("probe/joint.mo", model="joint.Probe")
ramp = probe.simulate(t=(0, 0.99), dt=0.0017)
table = rows()


def truth(x_mm):
    """Between neighbouring rows 1.9 % apart, by Hermite's rule: far better than the tables."""
    i = next(i for i in range(1, len(table)) if table[i][0] >= x_mm)
    (x0, f0, k0), (x1, f1, k1) = table[i - 1], table[i]
    h = x1 - x0
    s, m = (x_mm - x0) / h, (f1 - f0) / h
    return f0 + h * s * (k0 + s * ((3 * m - 2 * k0 - k1) + s * (k0 + k1 - 2 * m)))


compared, worst = 0, 0.0
for x, f in zip(ramp["x"], ramp["f"]):
    if 1e-4 < 1e3 * x < 0.0298:
        compared += 1
        worst = max(worst, abs(f / truth(1e3 * x) - 1.0))
print(f"{compared} forces on a ramp: within {100 * worst:.3g} %")
assert compared > 500 and worst < 1e-3, (compared, worst)
