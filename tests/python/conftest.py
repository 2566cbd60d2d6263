"""What every test of the package sees: rlslab and np in the examples of docstrings, a folder of its own to write in."""

import numpy as np
import pytest

import rlslab

try:
    from hypothesis import HealthCheck, settings
except ImportError:
    pass
else:
    settings.register_profile("quick", max_examples=60, deadline=None, derandomize=True)
    # By hand, under the address sanitizer: pytest -k test_hostile --hypothesis-profile=long
    settings.register_profile(
        "long", max_examples=20000, deadline=None, suppress_health_check=list(HealthCheck), database=None
    )
    settings.load_profile("quick")


@pytest.fixture
def examples(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return {"rlslab": rlslab, "np": np}
