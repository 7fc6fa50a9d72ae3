"""A spring between two nodes, pulled by displacements that no table holds: the force at the held node."""

import subprocess

from truth import ERROR, rows

with open("joint_calculix.inp") as file:
    spring = file.read()
picked = rows()[60::40]
steps = "".join(
    f"*STEP\n*STATIC\n1., 1.\n*BOUNDARY\n2, 1, 1, {x!r}\n*NODE PRINT, NSET=held\nRF\n*END STEP\n" for x, _, _ in picked
)
deck = f"""*NODE, NSET=all
1, 0., 0., 0.
2, 1., 0., 0.
*NSET, NSET=held
1
*ELEMENT, TYPE=SPRINGA, ELSET=joint
1, 1, 2
{spring}*BOUNDARY
1, 1, 3
2, 2, 3
{steps}"""
with open("spring.inp", "w") as file:
    file.write(deck)
done = subprocess.run(["ccx", "spring"], capture_output=True, text=True)
with open("spring.dat") as file:
    lines = [line.split() for line in file]
forces = [abs(float(line[1])) for line in lines if len(line) == 4 and line[0] == "1"]
assert len(forces) == len(picked) > 10, (len(forces), done.stdout[-2000:])
worst = max(abs(found / truth - 1.0) for found, (_, truth, _) in zip(forces, picked))
print(f"CalculiX: within {100 * worst:.3g} % at {len(picked)} unseen elongations")
assert worst < ERROR, worst
