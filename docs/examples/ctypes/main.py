"""y = 0.8 u(k) - 0.3 u(k-1) and a little noise; one row is wrong. A guard finds it, and the filter goes on."""
import rlslab_c as rlslab

s = 1


def draw():
    global s
    s = (1664525 * s + 1013904223) % 2**32
    return s / 2**31 - 1


filter = rlslab.Filter("ud", "double", 2, forgetting=0.99, guard="reset")
signals, healths = rlslab.names(rlslab.SIGNALS), rlslab.names(rlslab.HEALTHS)
u = 0
for row in range(300):
    before, u = u, draw()
    y = 0.8 * u - 0.3 * before + 0.01 * draw()
    if row == 200:
        y += 5
    step = filter.update([u, before], y)
    if step.signal:
        print(f"row {row}: {signals[step.signal]}")
theta = filter.theta()
print(f"theta {theta[0]:.2f} {theta[1]:.2f}")
print(f"{filter.counts().outliers} outlier, {healths[step.health]}")
try:
    rlslab.Filter("udd", "double", 2)
except ValueError as error:
    print(str(error)[:16])
