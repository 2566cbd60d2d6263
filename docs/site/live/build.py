#!/usr/bin/env python3
"""Puts the live page together: one HTML file that asks no machine for anything.

usage: build.py FACTS_PROGRAM OUT.html

FACTS_PROGRAM is the native rlslab_live_facts. The module is compiled by emcc from the unchanged headers; it stands in
the page compressed, in base64. Beside OUT.html stay page.wasm and facts.json, for drive.mjs.
"""
import base64
import gzip
import json
import pathlib
import re
import subprocess
import sys

here = pathlib.Path(__file__).resolve().parent
root = here.parents[2]
most_bytes, most_compressed = 600_000, 200_000


def compiled(out):
    # -ffp-contract=off and no fast-math, as everywhere: every operation rounds once, in the order written.
    subprocess.run(["emcc", "-std=c++20", "-O2", "-fno-exceptions", "-ffp-contract=off", "-isystem",
                    "/usr/include/eigen3", "-I", root / "src", "-I", root, here / "page.cpp", here / "table.cpp",
                    here / "fma.cpp", "--no-entry", "-Wl,--wrap=fma",
                    "-sALLOW_MEMORY_GROWTH=1", "-o", out], check=True)
    return base64.b64encode(gzip.compress(out.read_bytes(), 9, mtime=0)).decode()


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    facts_program, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    out.parent.mkdir(parents=True, exist_ok=True)
    facts = json.loads(subprocess.run([facts_program, root / "studies/data"], check=True, capture_output=True).stdout)
    (out.parent / "facts.json").write_text(json.dumps(facts))
    del facts["hashes"]    # the test's, not the page's
    parts = {"page.wasm": compiled(out.parent / "page.wasm"),
             "facts.json": json.dumps(facts, separators=(",", ":")).replace("<", "\\u003c")}
    page = re.sub(r"@@([\w.]+)@@", lambda m: parts.get(m[1]) or (here / m[1]).read_text(),
                  (here / "page.html").read_text())
    compressed = len(gzip.compress(page.encode(), 9))
    if len(page.encode()) > most_bytes or compressed > most_compressed:
        sys.exit(f"{out}: {len(page.encode())} bytes, {compressed} compressed: more than it may have")
    out.write_text(page)
    print(f"{out}: {len(page.encode())} bytes, {compressed} compressed")


main()
