"""Why P goes indefinite: a notebook as a script. Cells begin at "# %%"; editors run them one by one.

usage: /usr/bin/python3 bindings/python/notebooks/why_p_goes_indefinite.py
"""

# %% The record: four white regressors, a little noise. Nothing about the data is hard.
import math

import numpy as np

import rlslab

rows = 6000
generator = np.random.default_rng(1)
Psi = generator.standard_normal((rows, 4))
y = Psi @ [1.0, -0.5, 0.25, 2.0] + 0.1 * generator.standard_normal(rows)


# %% The first row whose health is not sound, and how far P is from symmetric on the way there.
def first_breakdown(variant: str, forgetting: float, dtype: str) -> float:
    """The row, counted from 1; infinity where all are sound."""
    f = rlslab.filter(variant, 4, forgetting=forgetting, dtype=dtype)
    broken = np.flatnonzero(f.update_many(Psi, y, steps=True)["health"] != rlslab.HEALTHS.index("sound"))
    return int(broken[0]) + 1 if len(broken) else math.inf


def asymmetry(dtype: str, forgetting: float, upto: int, every: int) -> list[float]:
    """|P - P'| / |P| of `conventional`, every so many rows."""
    f = rlslab.Conventional(4, forgetting=forgetting, dtype=dtype)
    out = []
    for k in range(0, upto, every):
        f.update_many(Psi[k : k + every], y[k : k + every])
        P = f.covariance.astype(np.float64)
        out.append(float(np.linalg.norm(P - P.T) / np.linalg.norm(P)))
    return out


# %% P is stored whole. An antisymmetric part is divided by lambda at each row, and the data never see it: psi'A psi
# = 0. So it grows as lambda^-k until it is as large as P.
for forgetting in (0.99, 0.98, 0.95):
    memory = -1 / math.log(forgetting)    # rows in which the growth is e
    grown = asymmetry("float64", forgetting, round(16 * memory), round(memory))
    rate = math.log(grown[-1] / grown[3]) / (round(memory) * (len(grown) - 4))
    print(f"lambda {forgetting}: the asymmetry grows by {rate:.4f} a row; -log lambda = {1 / memory:.4f}")
    assert abs(rate * memory - 1) < 0.2

# %% More bits do not mend it; they buy rows. Rounding starts the growth at u, so that 29 bits more (float32 to float64)
# last 29 log 2 / -log lambda rows longer.
for forgetting in (0.99, 0.98, 0.95):
    short, long = (first_breakdown("conventional", forgetting, dtype) for dtype in ("float32", "float64"))
    law = 29 * math.log(2) / -math.log(forgetting)
    print(f"lambda {forgetting}: float32 breaks down at row {short}, float64 {long - short} later; law {law:.0f}")
    assert abs(long - short - law) < 0.2 * law

# %% What mends it: a symmetric P (`symmetric`), the row product on its own (`conventional_two_sided`), or a factor of
# P, which cannot be indefinite (`ud`, `potter`, `qr` ...).
for variant in rlslab.variants():
    breakdowns = {dtype: first_breakdown(variant, 0.98, dtype) for dtype in rlslab.arithmetics()}
    print(f"{variant:>24}: " + ", ".join(f"{dtype} {row}" for dtype, row in breakdowns.items()))
    assert math.isinf(breakdowns["float64"]) == (variant not in ("conventional", "kalman"))
