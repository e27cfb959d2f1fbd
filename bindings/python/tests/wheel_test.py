# SPDX-License-Identifier: Apache-2.0
"""Installs a wheel into a clean virtual environment, offline, and runs the README's example there.

  wheel_test.py SCRIPT LIBRARY WORK
"""

import os
import pathlib
import re
import subprocess
import sys
import venv


def main(script, library, work):
    work = pathlib.Path(work)
    wheel = subprocess.run([script, "--library", library, "--output", str(work / "dist")], check=True,
                           capture_output=True, text=True).stdout.strip().splitlines()[-1]
    # NumPy comes from the system: nothing may be fetched.
    venv.create(work / "venv", clear=True, system_site_packages=True, with_pip=True)
    python = str(work / "venv" / "bin" / "python3")
    subprocess.run([python, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", wheel],
                   check=True)
    readme = pathlib.Path(__file__).resolve().parents[1] / "README.md"
    text = readme.read_text()
    code = re.search(r"^```\w+\n(.*?)^```$", text, re.M | re.S)[1]
    code += "import kiwami._library as l; print(l.library._name)\n"
    clean = {"PATH": os.environ["PATH"], "HOME": os.environ.get("HOME", "/")}
    printed = subprocess.run([python, "-c", code], check=True, capture_output=True, text=True,
                             env=clean, cwd=work).stdout.splitlines()
    promised = re.search(r"It prints `(.*?)`", text)[1]
    if printed[0] != promised or not printed[1].startswith(str(work / "venv")):
        print(f"printed {printed}, expected {promised!r} by the wheel's library", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
