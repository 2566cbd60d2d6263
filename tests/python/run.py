"""run.py FILE...: pytest on files of this folder, for ctest. 77 with the reason where all of it must be skipped."""

import importlib.util
import sys
from pathlib import Path

for needed, package in (("numpy", "python3-numpy"), ("pytest", "python3-pytest")):
    if not importlib.util.find_spec(needed):
        print(f"skipped: no {needed} ({package})")
        sys.exit(77)

import pytest    # noqa: E402

if __name__ == "__main__":    # processes that a test starts import this file, and must not run the tests
    here = Path(__file__).parent
    files = [str(here / name) for name in sys.argv[1:]]
    code = pytest.main(["-q", "-rs", "-p", "no:cacheprovider", "--rootdir", str(here), *files])
    sys.exit(77 if code == pytest.ExitCode.NO_TESTS_COLLECTED else int(code))
