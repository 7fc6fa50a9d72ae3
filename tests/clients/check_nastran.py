"""The deck is read back; NLRGAP, which pyNastran keeps as text only, by its fields."""

import bisect

from pyNastran.bdf.bdf import BDF

from truth import check

deck = BDF(debug=False)
deck.read_bdf("joint.bdf", punch=True, xref=False)
assert deck.card_count["TABLED1"] == 2 and deck.card_count["PBUSHT"] == 1 and deck.card_count["PBUSH"] == 1
table, gap = deck.tables_d[1], deck.tables_d[2]
assert list(gap.y) == [0.02, 0.02] and deck.pbusht[10].kn_tables[0] == 1
assert deck.card_count["NLRGAP"] == 1
xs, ys = list(table.x), list(table.y)
assert table.xaxis == table.yaxis == "LINEAR" and xs == sorted(set(xs))


def force(x):
    i = bisect.bisect_right(xs, x)
    return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1])


check("TABLED1", force)
