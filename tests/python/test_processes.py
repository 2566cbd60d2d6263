"""Threads, forks and the end of the interpreter: an error or right numbers, never a crash."""

import os
import subprocess
import sys
import threading

import numpy as np
import pytest
from data import rows, same

import rlslab


def run(code, **more):
    return subprocess.run(
        [sys.executable, "-X", "faulthandler", "-c", code], capture_output=True, text=True, timeout=120, **more
    )


def test_threads_with_a_filter_each_run_at_once_with_the_same_bits():
    Psi, y = rows(20000, 8)
    filters = [rlslab.Ud(8, forgetting=0.99) for _ in range(4)]
    threads = [threading.Thread(target=f.update_many, args=(Psi, y)) for f in filters]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(same(f.theta, filters[0].theta) and f.counts.rows == 20000 for f in filters)


def test_a_filter_that_another_thread_uses_refuses():
    Psi, y = rows(400000, 16)
    f = rlslab.Ud(16)
    started = threading.Event()
    thread = threading.Thread(target=lambda: (started.set(), f.update_many(Psi, y)))
    thread.start()
    started.wait()
    refused = 0
    while thread.is_alive():
        for use in (lambda: f.update(Psi[0], y[0]), lambda: f.theta, f.reset if refused else f.copy, lambda: f.state,
                    lambda: f.update_many(Psi[:2], y[:2]), lambda: f.restore(b""), lambda: f.counts, f.pass_time):
            try:
                use()
            except RuntimeError as e:
                assert "another thread" in str(e)
                refused += 1
            except ValueError:
                pass
    thread.join()
    assert refused > 0
    f.update(Psi[0], y[0])


def test_threads_that_quarrel_do_not_crash():
    f = rlslab.Qr(3)
    Psi, y = rows(300, 3)

    def quarrel(k):
        for i in range(300):
            try:
                [lambda: f.update_many(Psi, y), lambda: f.update(Psi[i], y[i]), lambda: f.theta, f.reset][(i + k) % 4]()
            except RuntimeError:
                pass

    threads = [threading.Thread(target=quarrel, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    f.reset()
    assert f.update(Psi[0], y[0]).health == "sound"


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_child_goes_on_from_the_parents_filter():
    done = run("""if True:
        import os, threading, numpy as np, rlslab
        f, busy = rlslab.Ud(2), rlslab.Ud(16)
        f.update([1.0, 2.0], 3.0)
        rows = np.ones((300000, 16))
        thread = threading.Thread(target=busy.update_many, args=(rows, rows[:, 0]))
        thread.start()
        child = os.fork()
        f.update([2.0, 1.0], 3.0)
        if child == 0:
            try:
                busy.theta
            except RuntimeError:
                pass
            os._exit(0 if np.allclose(f.theta, [1, 1], atol=1e-3) else 1)
        thread.join()
        print(os.waitpid(child, 0)[1], np.allclose(f.theta, [1, 1], atol=1e-3))
    """)
    assert done.stdout.split() == ["0", "True"], done.stderr


@pytest.mark.parametrize(
    "end",
    [
        "atexit.register(lambda: print(f.update([1.0, 2.0], 3.0).health))",
        "class Late:\n    def __del__(self): print(f.update([1.0, 2.0], 3.0).health)\nlate = Late(); late.me = late",
        "sys.modules['kept'] = f; print('sound')",
        "sys.modules.pop('rlslab'); del rlslab; print(f.update([1.0, 2.0], 3.0).health)",
        "import importlib; importlib.reload(rlslab); print(rlslab.Ud(2).update([1.0, 2.0], 3.0).health)",
    ],
)
def test_the_end_of_the_interpreter(end):
    done = run(f"import atexit, sys, rlslab\nf = rlslab.Ud(2)\n{end}\n")
    assert done.returncode == 0 and done.stdout == "sound\n" and not done.stderr, (done.stdout, done.stderr)


@pytest.mark.parametrize(
    "call",
    [
        "f.update_many(rows, rows[:, 0], steps=True)",
        "f.update(whole, 1)",
        "f.update([slow] * 8, slow)",
        "fleet.update(rows, rows[:, 0])",
        "f.copy().restore(f.state)",
    ],
)
def test_a_thread_that_still_runs_when_the_interpreter_ends(call):
    for _ in range(3):
        done = run(f"""if True:
            import threading, time, numpy as np, rlslab
            rows, whole = np.ones((2000, 8)), np.ones(8, int)
            slow = np.array(1.0)    # an array in a list: converted by the package
            def work(f, fleet):
                while True: {call}
            for k in range(3):
                given = rlslab.Ud(8), rlslab.Fleet("ud", 2000, 8)
                threading.Thread(target=work, args=given, daemon=True).start()
            time.sleep(0.2)
        """)
        assert done.returncode == 0 and not done.stderr, done.stderr


def test_nothing_leaks():
    Psi, y = rows(50, 4)
    f = rlslab.Ud(4)
    bad = np.zeros(3)

    def all_calls():
        f.update(Psi[0], y[0]), f.update(Psi[0].tolist(), 1), f.update_many(Psi, y), f.update_many(Psi, y, steps=True)
        f.theta, f.gain, f.covariance, f.state, f.counts, f.health, f.copy(), repr(f), f.restore(f.state), f.pass_time()
        for call in (lambda: f.update(bad, 1), lambda: f.restore(b"x"), lambda: rlslab.Ud(0), lambda: f.information):
            try:
                call()
            except (ValueError, AttributeError):
                pass

    for _ in range(50):
        all_calls()
    before = sys.getrefcount(bad), sys.getrefcount(Psi), sys.getrefcount("sound"), sys.getrefcount(rlslab.Step)
    blocks = sys.getallocatedblocks()
    for _ in range(500):
        all_calls()
    assert sys.getallocatedblocks() - blocks < 100
    after = sys.getrefcount(bad), sys.getrefcount(Psi), sys.getrefcount("sound"), sys.getrefcount(rlslab.Step)
    assert max(b - a for a, b in zip(before, after)) < 20
