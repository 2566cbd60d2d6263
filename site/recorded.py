#!/usr/bin/env python3
"""What the site has of the program: docs/commands.md, its help, and site/terminal.svg, a run of it in a terminal.

recorded.py PROGRAM          writes them
recorded.py PROGRAM --check  says which of them differ
"""
import html
import pathlib
import re
import shlex
import subprocess
import sys

root = pathlib.Path(__file__).resolve().parent.parent
typed = ["compare data/sales.csv --input lead --output sales --order 2 --detrend --arithmetic float",
         "--variants conventional,joseph,ud,gentleman --no-timings"]
whole = " ".join(typed)
xmlns = "http:" "//www.w3.org/2000/svg"    # a name, which nobody asks for
step, top, left, glyph = 17, 52, 16, 7.25    # of a line, in pixels, and of a letter
style = """.t{font:12px ui-monospace,'DejaVu Sans Mono',Menlo,Consolas,monospace;fill:#d7dae0;white-space:pre}
.p{fill:#8fd19e}.b{fill:#fff;font-weight:600}.l{animation:show 3s 4s}@keyframes show{0%,99.9%{opacity:0}}
@keyframes type{from{width:0}}@media(prefers-reduced-motion:reduce),print{.l,#typed{animation:none!important}}"""


def drawn(lines):
    """Lines of a terminal as a picture: all of it for 4 s; then the command is typed, and its answer appears."""
    width = max(len(line) for line in lines) * glyph + 2 * left
    height = top + step * (len(lines) + 1)
    size = f'{width:.0f} {height}" width="{width:.0f}" height="{height}"'
    out = [f'<svg xmlns="{xmlns}" viewBox="0 0 {size} role="img">',
           f"<title>rlslab {html.escape(whole)}</title>", f"<style>{style}</style>",
           f'<rect width="{width:.0f}" height="{height}" rx="8" fill="#1d212b"/>',
           *(f'<circle cx="{x}" cy="18" r="5" fill="{colour}"/>'
             for x, colour in ((18, "#ff6058"), (36, "#ffbd2e"), (54, "#28c940"))),
           f'<clipPath id="c"><rect id="typed" x="0" y="0" width="{width:.0f}" height="{top + step + 6}"'
           f' style="animation:type 1.6s steps({len(lines[0])}) 4s"/></clipPath>',
           f'<text class="t" clip-path="url(#c)" x="{left}" y="{top}"><tspan class="p">$</tspan> '
           f"{html.escape(lines[0][2:])}</text>",
           f'<text class="t" clip-path="url(#c)" x="{left}" y="{top + step}">{html.escape(lines[1])}</text>']
    for i, line in enumerate(lines[2:], 2):
        kind = "t l b" if line.startswith(("in float", "* ")) else "t l"
        out.append(f'<text class="{kind}" style="animation-duration:{1.8 + .03 * i:.2f}s" x="{left}" '
                   f'y="{top + step * i}">{html.escape(line)}</text>' if line else "")
    return "\n".join(line for line in [*out, "</svg>"] if line) + "\n"


def said(program, *words):
    run = subprocess.run([program, *words], cwd=root, capture_output=True, text=True, check=True)
    return run.stdout.rstrip("\n")


def terminal(program):
    """The command, folded as one types it, and what it prints."""
    answer = said(program, *shlex.split(whole)).split("\n")
    return drawn([f"$ rlslab {typed[0]} \\", f"      {typed[1]}", *answer])


def commands(program):
    first = said(program, "help")
    names = re.findall(r"^  (\w+) {2,}", first.split("Commands:")[1].split("Options:")[0], re.M)
    text = ("# The program: its commands\n\nWritten by `site/recorded.py PROGRAM`; `man rlslab` has the same.\n\n"
            f"```text\n{first}\n```\n")
    return text + "".join(f"\n## {c}\n\n```text\n{said(program, 'help', c)}\n```\n" for c in names if c != "help")


if __name__ == "__main__":
    program = str(pathlib.Path(sys.argv[1]).resolve())
    made = {"docs/commands.md": commands(program), "site/terminal.svg": terminal(program)}
    wrong = [f"{path}: not what site/recorded.py writes" for path, text in made.items()
             if not (root / path).exists() or (root / path).read_text() != text]
    if sys.argv[2:] == ["--check"]:
        sys.exit("\n".join(wrong) if wrong else 0)
    for path, text in made.items():
        (root / path).write_text(text)
