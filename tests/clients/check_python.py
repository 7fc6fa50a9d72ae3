import os
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.getcwd())
import joint
from truth import check, rows

check("force", joint.force)
worst = max(abs(joint.stiffness(x) / k - 1.0) for x, _, k in rows())
assert worst < 3e-3, worst
assert joint.force(0.0) == joint.force(-1.0) == joint.stiffness(0.0) == joint.stiffness(-1.0) == 0.0
