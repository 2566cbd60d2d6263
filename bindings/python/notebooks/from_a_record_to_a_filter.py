"""From a record to a model and a running filter: a notebook as a script. Cells begin at "# %%".

usage: /usr/bin/python3 bindings/python/notebooks/from_a_record_to_a_filter.py
"""

# %% The record: sales, and an indicator that leads them.
from pathlib import Path

import numpy as np

import rlslab

record = np.genfromtxt(Path(__file__).parents[3] / "studies/data/sales.csv", delimiter=",", names=True)
lead, sales = record["lead"], record["sales"]

# %% Does the input tell enough? It must excite a model of the order that we want.
e = rlslab.excitation(lead)
print(e)
assert e.persistent_order > 6

# %% A first model. Its remarks say what is wrong with it, and what else to try.
m = rlslab.identify(sales, lead, max_order=4)
print(m.structure, *m.remarks, sep="\n  ")
assert any("not white" in remark for remark in m.remarks) and any("--delay 3" in remark for remark in m.remarks)

# %% Nothing happens before three steps have passed. With that delay the residuals are white: what is left cannot be
# predicted from the past.
m = rlslab.identify(sales, lead, max_order=4, delay=3)
print(m.equation, *m.remarks, sep="\n  ")
for name, theta, sd, (low, high) in zip(m.names, m.params, m.bse, m.conf_int(0.05)):
    print(f"  {name:>3} {theta:8.3f}  sd {sd:.3f}  {low:8.3f} ... {high:.3f}")
assert m.to_dict()["whiteness"]["white"] and abs(m.poles).max() < 1

# %% The model predicts the last third, which it has not seen.
print(f"held out: {m.fit['held_out_one_step']:.1f} % one step ahead")
assert m.fit["held_out_one_step"] > 90

# %% A filter for the same equation: `rows` makes psi and y of a record, `filter` has the model's variant and prior. On
# the fitted rows it finds theta, bit for bit.
Psi, y = m.rows(sales, lead)
f = m.filter()
f.update_many(Psi[: m.nobs], y[: m.nobs])
assert np.array_equal(f.theta, m.params)

# %% It runs on in float32, forgets slowly, and has a guard: a missing value and a slip of the keyboard do no harm.
f = m.filter(dtype="float32", forgetting=0.99, guard="reset")
f.update_many(Psi[: m.nobs], y[: m.nobs])
arriving, slips = Psi[m.nobs :].copy(), y[m.nobs :].copy()
arriving[10, 0] = np.nan
slips[20] *= 10
innovation = []
for psi, output in zip(arriving, slips):
    step = f.update(psi, float(output))
    if step.signal not in ("unusable", "outlier"):
        innovation.append(step.innovation)
spread = np.std(y[m.nobs :])
print(f"innovations {np.std(innovation):.2f} of {spread:.2f}, {f.counts.outliers} outlier, {f.counts.unusable} missing")
assert (f.counts.outliers, f.counts.unusable) == (1, 1) and np.std(innovation) < 0.1 * spread

# %% Save it, go on later: here, in C++ or in C.
later = m.filter(dtype="float32", guard="reset")
later.restore(f.state)
assert later.update(Psi[-1], y[-1]) == f.copy().update(Psi[-1], y[-1])
print(f"theta {f.theta.round(2)}, health {f.health}")
