"""Type hints: mypy --strict on the package and on a program that uses it."""

import subprocess
import sys
from pathlib import Path

import pytest

import rlslab

pytest.importorskip("mypy")
FOLDER = Path(rlslab.__file__).parent

PROGRAM = """
import numpy as np
import rlslab

f = rlslab.Ud(4, forgetting=0.99, guard="reset", control=("fortescue", 0.1, 50))
step = f.update([1.0, 2.0, 0.5, 3.0], 0.7)
innovation: float = step.innovation
health: str = step.health
table = f.update_many(np.zeros((3, 4)), np.zeros(3), steps=True)
gamma = table["gamma"]
last = f.update_many(np.zeros((3, 4)), np.zeros(3), weights=[1, 0, 2])
gone: bool = f.remove([1.0, 2.0, 0.5, 3.0], 0.7, weight=f.update(np.ones(4), 1.0, 0.5).gamma).refused
likely_thetas = f.sample(1, 10, scale=0.1) @ f.least_excited().direction + f.variance(np.eye(4)) + f.factor.sum()
unexcited: str = f.least_excited().sentence
f.merge(f)
norm = float(np.linalg.norm(f.theta)) + f.counts.rows
g: rlslab.Ud = f.copy()
h: rlslab.Filter = rlslab.filter("qr", 3, dtype="float32")
fleet = rlslab.Fleet("ud", filters=3, size=2)
missing: int = fleet.update(np.zeros((3, 2)), np.zeros(3))
then, walked = fleet.update_many(np.zeros((2, 3, 2)), np.zeros((2, 3)), steps=True, theta=True)
worst = fleet.update(np.zeros((3, 2)), np.zeros(3), steps=True)["gamma"].min() + fleet.covariance[0].sum()
many = rlslab.Outputs("qr_block", 4, 2, prior_variance=None)
words: str = many.update_many(np.zeros((3, 4)), np.zeros((3, 2)), unusable="leave_out") + many.copy().health
predicted = np.zeros((3, 4)) @ many.theta
rlslab.QrBlock(4, outputs=2)
c: rlslab.Comparison = rlslab.compare(np.zeros((3, 4)), [1, 2, 3], digits=3, arithmetics="float32", control=("ridge",))
again: rlslab.Filter = c.filter(guard="reset")
names: list[str] = [str(record["variant"]) for record in c.records] + c.warnings
m = rlslab.identify(np.zeros(9), np.zeros((9, 2)), na=2, nb=[1, 2], delay=1)
later: rlslab.Filter = rlslab.from_state(f.state)
likely = float(m.pvalues @ m.recursive_coefficients[-1])
width = float(np.ptp(m.conf_int(0.1)[0])) + m.scale + float(abs(m.poles).max())
exact = rlslab.certified(np.zeros((3, 4)), np.zeros(3), forgetting=0.9, prior_variance=1.0)
digits: float = exact.digits(m.params) + float(exact.theta[0])
order: int = rlslab.excitation(np.zeros(9), max_order=3).order
rows = rlslab.sweep(np.zeros((3, 4)), np.zeros(3), {"forgetting": [0.9, 1], "prior": "scaled"}).records
theta, sigma = rlslab.rolling(np.zeros((3, 2)), [1, 2, 3], 2, groups=["a", "b", "a"], returns=("theta", "sigma"))
path = f.update_many(np.zeros((3, 4)), np.zeros(3), theta=True)[-1] @ np.zeros(4)
both, then_too = f.update_many(np.zeros((3, 4)), np.zeros(3), steps=True, theta=True)
last_t = rlslab.rolling(np.zeros((3, 2)), np.zeros(3), forgetting=0.9, min_periods=2).t[-1]
verdicts = rlslab.study("choose", set={"kappa": 10}, out="folder").verdicts
text: str = rlslab.cite("ud") + c.code + c.table() + m.summary()
"""
WRONG = """
import rlslab

f, _ = rlslab.Ud(4), rlslab.Ud(4, colour="red")
f.theta = 3
n: int = f.update([1.0], 2.0).health
rlslab.Udd(3)
rlslab.compare([[1.0]], [1.0], digit=3)
rlslab.certified([[1.0]], [1.0]).theta = 3
x: int = rlslab.identify([1.0]).params
rlslab.rolling([1.0], [1.0], windows=3)
rlslab.rolling([1.0], [1.0]).tt
"""


def mypy(*arguments, cwd):
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(cwd / "cache"), *arguments]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True)


def test_the_package_and_a_program(tmp_path):
    (tmp_path / "program.py").write_text(PROGRAM)
    done = mypy(str(FOLDER), "program.py", cwd=tmp_path)
    assert done.returncode == 0, done.stdout


def test_wrong_programs_are_found(tmp_path):
    (tmp_path / "wrong.py").write_text(WRONG)
    done = mypy("wrong.py", cwd=tmp_path)
    lines = {int(line.split(":")[1]) for line in done.stdout.splitlines() if ": error: " in line}
    assert lines == {4, 5, 6, 7, 8, 9, 10, 11, 12}
