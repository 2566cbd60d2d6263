"""The code of the variants' pages as programs: blocks.py FOLDER writes dense.cpp, sparse.cpp and dense.c, each of which
runs all its blocks; blocks.py --python runs the Python blocks against the package in PYTHONPATH: 77 with the reason
where there is none."""
import doctest
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs/site"))
from header import variants    # noqa: E402
from pages import code_of      # noqa: E402


def joined(blocks, nothing):
    """Programs as one: their includes, each main under a name of its own, and a main that runs them."""
    includes = sorted({line for code in blocks.values() for line in re.findall(r"^#include.*$", code, re.M)})
    bodies = [re.sub(r"^#include.*\n", "", code, flags=re.M).replace("int main(", f"static int run_{name}(")
              for name, code in blocks.items()]
    bodies = [re.sub(r"(?<!return 0;)\n\}\n*$", "\n    return 0;\n}\n", body) for body in bodies]    # main alone has it
    runs = " || ".join(f"run_{name}()" for name in blocks)
    return "\n".join([*includes, *bodies, f"int main({nothing}) {{ return {runs}; }}\n"])


def main():
    blocks = {h.name: code_of(h) for h in variants()}
    if sys.argv[1:] == ["--python"]:
        try:
            import numpy
            import rlslab
        except ImportError as missing:
            print(f"skipped: {missing}")
            return 77
        failed = 0
        for name, code in blocks.items():
            if "Python" in code:
                names = {"np": numpy, "rlslab": rlslab}
                test = doctest.DocTestParser().get_doctest(code["Python"], names, name, None, 0)
                failed += doctest.DocTestRunner().run(test).failed
        return int(failed > 0)
    folder = pathlib.Path(sys.argv[1])
    sparse = {n: b["C++"] for n, b in blocks.items() if "C" not in b}
    (folder / "dense.cpp").write_text(joined({n: b["C++"] for n, b in blocks.items() if "C" in b}, ""))
    (folder / "sparse.cpp").write_text(joined(sparse, ""))
    (folder / "dense.c").write_text(joined({n: b["C"] for n, b in blocks.items() if "C" in b}, "void"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
