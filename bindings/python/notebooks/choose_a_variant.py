"""Choose a variant for your data: a notebook as a script. Cells begin at "# %%"; editors run them one by one.

usage: /usr/bin/python3 bindings/python/notebooks/choose_a_variant.py
"""

# %% The record: the change of sales follows that of a leading indicator after three steps. Nearly dependent columns
# are what makes a filter lose digits, so we also ask about the same record with one more column, the sum of two.
from pathlib import Path

import numpy as np

import rlslab

record = np.genfromtxt(Path(__file__).parents[3] / "studies/data/sales.csv", delimiter=",", names=True)
lead, sales = np.diff(record["lead"]), np.diff(record["sales"])
Psi = np.column_stack([sales[3:-1], lead[1:-3], lead[:-4]])
y = sales[4:]
noise = np.random.default_rng(1).standard_normal(len(y))
hard = np.column_stack([Psi, Psi[:, 1] + Psi[:, 2] + 1e-4 * noise])

# %% Which variant? The answer is for this record: its rows, its forgetting, its prior.
c = rlslab.compare(Psi, y, timings=False)
print(c)
for advice in c.recommended:
    print(f"  {advice['arithmetic']}: {advice['variant']}")
assert c.best is not None and not c.warnings

# %% The digits of each variant in float: at nine tenths of the rows the worst component has at least so many. In a
# notebook `c` alone shows the table, and `c.plot()` draws it.
for r in sorted((r for r in c.records if r["arithmetic"] == "float"), key=lambda r: -r["worst_low"]):
    print(f"  {r['variant']:>24}: {r['worst_low']} digits, {r['operations']} operations a row")
digits = {r["variant"]: r["worst_low"] for r in c.records if r["arithmetic"] == "float"}
assert digits["ud"] > digits["conventional"] + 1

# %% Four digits wanted, of every parameter, in the shortest arithmetic that keeps them: float on the one record, double
# on the other.
for name, X in (("as it is", Psi), ("nearly dependent", hard)):
    wanted = rlslab.compare(X, y, digits=4, timings=False)
    assert wanted.best is not None
    print(f"  {name}: condition {wanted.condition:.1g}, {wanted}")
    f = wanted.filter()
    f.update_many(X, y)
    kept = rlslab.certified(X, y).digits_worst(f.theta)
    print(f"    {f.variant} in {f.dtype}: {kept:.1f} digits of the exact least squares, proven")
    assert kept >= 4
assert rlslab.compare(hard, y, digits=4, timings=False).best["arithmetic"] == "double"

# %% Does the advice hold as the filter forgets? A sweep asks for several values at once.
s = rlslab.sweep(Psi, y, {"forgetting": [0.9, 0.98, 1], "arithmetic": "float32", "variant": ["conventional", "ud"]})
for r in s.records:
    print(f"  {r['variant']:>12}, lambda {r['forgetting']}: {r['worst_low']:.1f} digits")
low = {(r["variant"], r["forgetting"]): r["worst_low"] for r in s.records}
assert all(low["ud", forgetting] > low["conventional", forgetting] for forgetting in (0.9, 0.98, 1))

# %% The filter for the program in C++, and what to cite.
print(c.code)
print(rlslab.cite(c.best["variant"]))
assert "rlslab::" in c.code
