import opensim

from truth import check

read = opensim.OpenSimObject.makeObjectFromFile("joint_opensim.xml")
function = opensim.PiecewiseLinearFunction.safeDownCast(read)
assert function is not None and function.getSize() > 6


def force(x_mm):
    return function.calcValue(opensim.Vector(1, 1e-3 * x_mm))


# Its first point: below, one straight line.
first = 1e3 * function.getX(3)
assert 1e-4 < first < 2e-3, first
check("PiecewiseLinearFunction", force, above=first)
assert force(-0.01) == 0.0 and force(0.0) == 0.0
