"""table.parquet and table.csv.zst, as pyarrow and polars read them, against table.csv."""

import csv

import polars
import pyarrow.parquet

with open("family/table.csv") as file:
    expected = list(csv.DictReader(file))
assert len(expected) == 60, len(expected)


def same(found, cell):
    if isinstance(found, float):
        # Results have nine digits in the CSV.
        return abs(found - float(cell)) <= 1e-8 * abs(found)
    return str(found if found is not None else "") == cell


table = pyarrow.parquet.read_table("family_parquet/table.parquet")
frame = polars.read_parquet("family_parquet/table.parquet")
compressed = polars.read_csv("family_zst/table.csv.zst")
assert table.column_names == frame.columns == compressed.columns == list(expected[0])
compared = 0
for rows in (table.to_pylist(), frame.to_dicts(), compressed.to_dicts()):
    assert len(rows) == len(expected)
    for found, row in zip(rows, expected):
        for name, cell in row.items():
            assert same(found[name], cell), (name, found[name], cell)
            compared += 1
assert compared == 3 * 60 * 28, compared
# A query of one column and a part of the rows.
lazy = polars.scan_parquet("family_parquet/table.parquet").filter(polars.col("radial_clearance_mm") > 0.03)
some = [float(row["force_n"]) for row in expected if float(row["radial_clearance_mm"]) > 0.03]
assert abs(lazy.select("force_n").collect()["force_n"].sum() / sum(some) - 1.0) < 1e-8
metadata = pyarrow.parquet.read_metadata("family_parquet/table.parquet").metadata
assert b'"unit":"N/mm"' in metadata[b"columns"], metadata
print(f"table.parquet and table.csv.zst: {compared} cells are those of table.csv")
