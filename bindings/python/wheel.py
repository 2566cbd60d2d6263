"""Packs the installed package as a wheel. usage: wheel.py FOLDER_OF_THE_PACKAGES OUT; prints the wheel's path."""

import base64
import hashlib
import re
import sys
import sysconfig
import zipfile
from pathlib import Path

METADATA = """Metadata-Version: 2.1
Name: rlslab
Version: {version}
Summary: Recursive least squares: every textbook variant, with the same bits as in C++
License: MIT
Requires-Python: >=3.11
Requires-Dist: numpy>=1.24
Provides-Extra: sklearn
Requires-Dist: scikit-learn>=1.2; extra == "sklearn"
"""
WHEEL = """Wheel-Version: 1.0
Generator: rlslab
Root-Is-Purelib: false
Tag: {tag}
"""


def main(site: Path, out: Path) -> Path:
    text = (site / "rlslab/_variants.py").read_text()
    found = re.search(r"^VERSION = ['\"](.+)['\"]$", text, re.M)
    assert found, "_variants.py names no version"
    version = found[1]
    tag = "cp311-abi3-" + re.sub(r"[-.]", "_", sysconfig.get_platform())
    info = f"rlslab-{version}.dist-info"
    files = {str(p.relative_to(site)): p.read_bytes() for p in sorted((site / "rlslab").iterdir()) if p.is_file()}
    files[f"{info}/METADATA"] = METADATA.format(version=version).encode()
    files[f"{info}/WHEEL"] = WHEEL.format(tag=tag).encode()
    record = ""
    for name, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(data)}\n"
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    out.mkdir(parents=True, exist_ok=True)
    wheel = out / f"rlslab-{version}-{tag}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name)    # of 1980: the same bytes from the same files
            entry.external_attr = (0o755 if name.endswith(".so") else 0o644) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, data)
    return wheel


if __name__ == "__main__":
    print(main(Path(sys.argv[1]), Path(sys.argv[2])))
