#!/usr/bin/env python3
"""Writes docs/commands.md: the help of each command, as the program prints it.

commands.py PROGRAM          writes it
commands.py PROGRAM --check  says whether it differs
"""
import pathlib
import re
import subprocess
import sys

page = pathlib.Path(__file__).resolve().parent.parent / "docs/commands.md"


def said(program, *words):
    return subprocess.run([program, "help", *words], capture_output=True, text=True, check=True).stdout.rstrip()


if __name__ == "__main__":
    program = sys.argv[1]
    first = said(program)
    commands = re.findall(r"^  (\w+) {2,}", first.split("Commands:")[1].split("Options:")[0], re.M)
    text = ("# The program: its commands\n\nWritten by `site/commands.py PROGRAM`; `man rlslab` has the same.\n\n"
            f"```text\n{first}\n```\n")
    text += "".join(f"\n## {c}\n\n```text\n{said(program, c)}\n```\n" for c in commands if c != "help")
    if sys.argv[2:] == ["--check"]:
        sys.exit(page.read_text() != text and "docs/commands.md is not what site/commands.py writes now")
    page.write_text(text)
