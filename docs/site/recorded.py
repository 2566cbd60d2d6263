#!/usr/bin/env python3
"""What the site has of the program: commands.md, its help, and terminal.svg, a run of it in a terminal.

recorded.py PROGRAM          writes them
recorded.py PROGRAM --check  says which of them differ
"""
import fcntl
import html
import os
import pathlib
import pty
import re
import struct
import subprocess
import sys
import termios

root = pathlib.Path(__file__).resolve().parents[2]
whole = "compare --example sales --arithmetic float --no-timings --variants conventional,joseph,ud,ud_delta"
xmlns = "http:" "//www.w3.org/2000/svg"    # a name, which nobody asks for
step, top, left, glyph = 17, 52, 16, 7.25    # of a line, in pixels, and of a letter
wide, narrow, rows = 98, 52, 42    # columns, and rows that are seen
telephone = 560    # pixels: a picture that is drawn in fewer is the narrow one
style = f""".t{{font:12px ui-monospace,'DejaVu Sans Mono',Menlo,Consolas,monospace;fill:#d7dae0;white-space:pre}}
.p{{fill:#8fd19e}}.b{{fill:#fff;font-weight:600}}.l{{animation:show 3s 4s}}@keyframes show{{0%,99.9%{{opacity:.2}}}}
.y{{animation:type 1.6s steps(100) 4s}}@keyframes type{{from{{width:0}}}}
@media(prefers-reduced-motion:reduce),print{{.l,.y{{animation:none!important}}}}
#n{{display:none}}@media(max-width:{telephone}px){{#w{{display:none}}#n{{display:inline}}}}"""


def pixels(columns):
    return columns * glyph + 2 * left


def drawn(name, command, lines, columns):
    """Lines of a terminal: all of them for 4 s; then the command is typed, and its answer appears."""
    shown, n = [*command, *lines], len(command)
    out = [f'<clipPath id="c{name}"><rect class="y" width="{pixels(columns):.0f}" height="{top + step * n - 11}"/>'
           "</clipPath>"]
    best, within = False, False    # the answer may be of several lines
    for i, line in enumerate(shown):
        best = (best and line != "") or line.startswith("in float")
        within = within or best
        kind = "t" if i < n else "t l b" if best or line.startswith("* ") else "t l"
        after = f' clip-path="url(#c{name})"' if i < n else f' style="animation-duration:{1.8 + .03 * i:.2f}s"'
        text = html.escape(line).replace("$ ", '<tspan class="p">$</tspan> ', i == 0)
        out.append(f'<text class="{kind}"{after} x="{left}" y="{top + step * i}">{text}</text>' if line else "")
    if best or not within or max(map(len, shown)) > columns:
        raise SystemExit(f"terminal.svg: in {columns} columns the answer is not whole")
    return f'<g id="{name}">' + "\n".join(line for line in out if line) + "</g>"


def folded(columns):
    """The command as one types it in so many columns."""
    lines = ["$ rlslab"]
    for words in re.findall(r"(?:-\S+|compare) ?[^-]*", whole):
        if len(lines[-1]) + len(words) + 3 > columns:
            lines[-1] += " \\"
            lines.append("     ")
        lines[-1] += " " + words.strip()
    return lines


def said(program, *words):
    run = subprocess.run([program, *words], cwd=root, capture_output=True, text=True, check=True)
    return run.stdout.rstrip("\n")


def answer(program, columns):
    """What the command prints on a terminal of so many columns, without colours."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
    plain = os.environ | {"NO_COLOR": "1"}
    with subprocess.Popen([program, *whole.split()], cwd=root, stdout=theirs, env=plain) as run:
        os.close(theirs)
        text = b""
        try:
            while part := os.read(ours, 1 << 16):
                text += part
        except OSError:    # the terminal's last writer is gone
            pass
    os.close(ours)
    if run.returncode:
        raise SystemExit(f"{program} {whole}: exit code {run.returncode}")
    return text.decode().replace("\r\n", "\n").rstrip("\n").split("\n")


def terminal(program):
    """The command and the top of its answer, in the columns that the picture has: a telephone's are fewer."""
    width, height, scale = pixels(wide), top + step * rows, pixels(wide) / pixels(narrow)
    size = f"{width:.0f} {height}"
    out = [f'<svg xmlns="{xmlns}" viewBox="0 0 {size}" width="{width:.0f}" height="{height}" role="img">',
           f"<title>rlslab {html.escape(whole)}</title>", f"<style>{style}</style>",
           f'<rect width="{width:.0f}" height="{height}" rx="8" fill="#1d212b"/>',
           *(f'<circle cx="{x}" cy="18" r="5" fill="{colour}"/>'
             for x, colour in ((18, "#ff6058"), (36, "#ffbd2e"), (54, "#28c940")))]
    for name, columns, seen in (("w", wide, rows), ("n", narrow, int((height / scale - top) / step) + 1)):
        command = folded(columns)
        out.append(drawn(name, command, answer(program, columns)[:seen - len(command)], columns))
    out[-1] = out[-1].replace('id="n"', f'id="n" transform="scale({scale:.4f})"', 1)
    return "\n".join([*out, "</svg>"]) + "\n"


def commands(program):
    first = said(program, "help")
    names = re.findall(r"^  (\w+) {2,}", first.split("Commands:")[1].split("Options:")[0], re.M)
    text = ("# The program: its commands\n\nWritten by `docs/site/recorded.py PROGRAM`; `man rlslab` has the same.\n\n"
            f"```text\n{first}\n```\n")
    return text + "".join(f"\n## {c}\n\n```text\n{said(program, 'help', c)}\n```\n" for c in names if c != "help")


if __name__ == "__main__":
    program = str(pathlib.Path(sys.argv[1]).resolve())
    made = {"docs/site/commands.md": commands(program), "docs/site/terminal.svg": terminal(program)}
    wrong = [f"{path}: not what docs/site/recorded.py writes" for path, text in made.items()
             if not (root / path).exists() or (root / path).read_text() != text]
    if sys.argv[2:] == ["--check"]:
        sys.exit("\n".join(wrong) if wrong else 0)
    for path, text in made.items():
        (root / path).write_text(text)
