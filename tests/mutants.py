#!/usr/bin/env python3
"""Do the laws still catch? One change of one operator at a time in the library, and the tests of its room.

mutants.py draw SEED N [TREE]    N lines of the library as changes: FILE, a tab, the line, a tab, the line changed
mutants.py run LIST BUILD [I...] in a tree built in BUILD, whose files it changes and restores: `killed`, `survived`, or
                                 `gone` where no such line stands there any more, for each, or for those numbered I

tests/mutants.txt was drawn from the tree that edition four began with; a file is found there by its name.
"""
import pathlib
import random
import re
import subprocess
import sys

root = pathlib.Path(__file__).resolve().parents[1]
changes = [(r" \+ ", " - "), (r" - ", " + "), (r" \* ", " / "), (r" / ", " * "), (r" < ", " <= "), (r" <= ", " < "),
           (r" > ", " >= "), (r" >= ", " > "), (r" == ", " != "), (r" != ", " == "), (r" && ", " || "),
           (r" \|\| ", " && "), (r" \+= ", " -= "), (r" -= ", " += "), (r"\btrue\b", "false"), (r"\bfalse\b", "true"),
           (r"\+\+(?=\w)", "--"), (r"\bmax\(", "min("), (r"\bmin\(", "max("), (r"return -", "return ")]
rooms = {"core": ["core", "linalg"], "arithmetic": ["arithmetic"], "linalg": ["linalg", "variants"],
         "reference": ["reference", "model"],
         "input": ["input"], "model": ["model"], "state": ["state"], "adapt": ["adapt"], "many": ["many"],
         "variants": ["variants"], "fast": ["fast"], "catalogue": ["catalogue", "capi"]}


def room(file):
    """The room of a file of the library; "" of what no test of a room is of."""
    parts = [p for p in file.parts[:-1] if p not in ("src", "rlslab")]
    return "fast" if "fast" in parts else next((p for p in parts if p in rooms), "")


def sources(tree):
    listed = subprocess.run(["git", "-C", tree, "ls-files"], capture_output=True, text=True, check=True).stdout.split()
    files = [pathlib.Path(f) for f in listed if f.endswith((".hpp", ".cpp"))]
    of_library = ("src", "variants", "catalogue", "fast")
    return [f for f in files if f.parts[0] in of_library and room(f) and "lab" not in f.parts]


def draw(seed, count, tree):
    """Lines that stand once in their file, no comment, no preprocessor's, no template's head, no text's."""
    g, files, out = random.Random(seed), sources(tree), []
    while len(out) < count:
        file = g.choice(files)
        lines = (tree / file).read_text().split("\n")
        line = g.choice(lines)
        bare = line.split("//")[0]
        found = [c for c in changes if re.search(c[0], bare)]
        head = re.match(r"\s*(#|template|static_assert|using|requires)|.*[\"']", bare)
        if head or not found or lines.count(line) > 1:
            continue
        what, by = g.choice(found)
        place = g.choice(list(re.finditer(what, bare)))
        out.append((file, line, line[: place.start()] + by + line[place.end() :]))
    return out


def run(list_file, build, chosen):
    files = {}
    for f in sources(root):
        files.setdefault(f.name, []).append(f)
    for i, row in enumerate(pathlib.Path(list_file).read_text().split("\n")[:-1], 1):
        if chosen and i not in chosen:
            continue
        file, old, new = row.split("\t")
        here = [f for f in files.get(pathlib.Path(file).name, []) if (root / f).read_text().split("\n").count(old) == 1]
        if len(here) != 1:
            print(i, "gone", file, flush=True)
            continue
        path, said = root / here[0], "survived"
        text = path.read_text()
        path.write_text("\n".join(new if line == old else line for line in text.split("\n")))
        try:
            for one in rooms[room(here[0])]:
                made = subprocess.run(["ninja", "-C", build, f"room_{one}"], capture_output=True)
                tests = made.returncode == 0 and subprocess.run(
                    ["ctest", "--test-dir", build, "-R", f"^{one}/", "-j2", "--stop-on-failure", "--timeout", "300"],
                    capture_output=True)
                if made.returncode or tests.returncode:
                    said = "killed by the compiler" if made.returncode else f"killed by {one}"
                    break
        finally:
            path.write_text(text)
        print(i, said, here[0], new.strip(), flush=True)


if __name__ == "__main__":
    if len(sys.argv) >= 4 and sys.argv[1] == "draw":
        for row in draw(sys.argv[2], int(sys.argv[3]), pathlib.Path(sys.argv[4]) if len(sys.argv) > 4 else root):
            print(*row, sep="\t")
    elif len(sys.argv) >= 4 and sys.argv[1] == "run":
        run(sys.argv[2], sys.argv[3], set(map(int, sys.argv[4:])))
    else:
        sys.exit(__doc__)
