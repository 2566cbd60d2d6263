"""The lines of tests/portability/digest.cpp, which has what is computed, from Python's ctypes."""
import os
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../docs/examples/ctypes"))
import rlslab_c as rlslab  # noqa: E402

d, rows, half = 5, 1000, 500
verb, folder = (sys.argv[1:] + ["", ""])[:2]


def records():
    s = 1
    for _ in range(rows):
        row = []
        for _ in range(d + 1):
            s = (1664525 * s + 1013904223) % 2**32
            row.append((s >> 8) / 2**23 - 1)
        yield row[:d], row[d]


def hashed(numbers):
    first = second = 1
    for byte in struct.pack(f"<{len(numbers)}d", *numbers):
        first, second = (257 * first + byte) % 4294967291, (65599 * second + byte) % 4294967291
    return f"{first:08x}{second:08x}"


every = list(records())
for arithmetic in rlslab.names(rlslab.ARITHMETICS):
    for variant in rlslab.names(rlslab.VARIANTS):
        filter = rlslab.Filter(variant, arithmetic, d, forgetting=0.9921875)
        path = os.path.join(folder, f"{variant}.{arithmetic}")
        if verb == "load":
            with open(path, "rb") as file:
                filter.load(file.read())
        for k in range(half if verb == "load" else 0, rows):
            if k == half and verb == "save":
                with open(path, "wb") as file:
                    file.write(filter.save())
            filter.update(*every[k])
        print(variant, arithmetic, hashed(filter.theta() + filter.gain() + filter.matrix()))
