# SPDX-License-Identifier: Apache-2.0
"""Runs the example of a README as its reader would, and checks that it prints what is promised.

  run_readme.py README FILE COMMAND...

The first code block of README is written to FILE. The commands are run one after the other in its
folder, with {file} and {folder} replaced; the last one must print what the README says between
'It prints `' and '`'.
"""

import pathlib
import re
import shlex
import subprocess
import sys


def main(readme, file, *commands):
    text = pathlib.Path(readme).read_text()
    code = re.search(r"^```\w+\n(.*?)^```$", text, re.M | re.S)[1]
    promised = re.search(r"It prints `(.*?)`", text)[1]
    path = pathlib.Path(file)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(code)
    printed = ""
    for command in commands:
        words = [word.format(file=path, folder=path.parent) for word in shlex.split(command)]
        printed = subprocess.run(words, check=True, cwd=path.parent, stdout=subprocess.PIPE,
                                 text=True).stdout
    if printed.strip() != promised:
        print(f"{readme}: printed {printed.strip()!r}, expected {promised!r}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
