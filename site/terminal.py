#!/usr/bin/env python3
"""Writes site/terminal.svg: a run of the program in a terminal, its lines as they were printed.

terminal.py PROGRAM          writes it
terminal.py PROGRAM --check  says whether it differs
"""
import html
import pathlib
import shlex
import subprocess
import sys

root = pathlib.Path(__file__).resolve().parent.parent
picture = root / "site/terminal.svg"
typed = ["compare data/sales.csv --input lead --output sales --order 2 --detrend --arithmetic float",
         "--variants conventional,joseph,ud,gentleman --no-timings"]
whole = " ".join(typed)
xmlns = "http:" "//www.w3.org/2000/svg"    # a name, which nobody asks for
step, top, left, glyph = 17, 52, 16, 7.25    # of a line, in pixels, and of a letter
style = """.t{font:12px ui-monospace,'DejaVu Sans Mono',Menlo,Consolas,monospace;fill:#d7dae0;white-space:pre}
.p{fill:#8fd19e}.b{fill:#fff;font-weight:600}.l{animation:show .01s both}@keyframes show{from{opacity:0}}
@keyframes type{from{width:0}}@media(prefers-reduced-motion:reduce){.l,#typed{animation:none!important}}"""


def drawn(lines):
    width = max(len(line) for line in lines) * glyph + 2 * left
    height = top + step * (len(lines) + 1)
    size = f'{width:.0f} {height}" width="{width:.0f}" height="{height}"'
    out = [f'<svg xmlns="{xmlns}" viewBox="0 0 {size} role="img">',
           f"<title>rlslab {html.escape(whole)}</title>", f"<style>{style}</style>",
           f'<rect width="{width:.0f}" height="{height}" rx="8" fill="#1d212b"/>',
           *(f'<circle cx="{x}" cy="18" r="5" fill="{colour}"/>'
             for x, colour in ((18, "#ff6058"), (36, "#ffbd2e"), (54, "#28c940"))),
           f'<clipPath id="c"><rect id="typed" x="0" y="0" width="{width:.0f}" height="{top + step + 6}"'
           f' style="animation:type 1.6s steps({len(lines[0])}) both"/></clipPath>',
           f'<text class="t" clip-path="url(#c)" x="{left}" y="{top}"><tspan class="p">$</tspan> '
           f"{html.escape(lines[0][2:])}</text>",
           f'<text class="t" clip-path="url(#c)" x="{left}" y="{top + step}">{html.escape(lines[1])}</text>']
    for i, line in enumerate(lines[2:], 2):
        kind = "t l b" if line.startswith(("in float", "* ")) else "t l"
        out.append(f'<text class="{kind}" style="animation-delay:{1.8 + .03 * i:.2f}s" x="{left}" y="{top + step * i}">'
                   f"{html.escape(line)}</text>" if line else "")
    return "\n".join(line for line in [*out, "</svg>"] if line) + "\n"


def recorded(program):
    """The command, folded as one types it, and what it prints."""
    run = subprocess.run([program, *shlex.split(whole)], cwd=root, capture_output=True, text=True, check=True)
    return [f"$ rlslab {typed[0]} \\", f"      {typed[1]}", *run.stdout.rstrip("\n").split("\n")]


if __name__ == "__main__":
    text = drawn(recorded(sys.argv[1]))
    if sys.argv[2:] == ["--check"]:
        sys.exit(picture.read_text() != text and "site/terminal.svg is not what site/terminal.py writes now")
    picture.write_text(text)
