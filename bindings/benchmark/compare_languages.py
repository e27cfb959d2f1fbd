# SPDX-License-Identifier: Apache-2.0
"""Traces the same batch of rays in every language, in turn with C, and prints a table of ratios.

  compare_languages.py [--build DIR] [--rays N] [--rounds N] [--repeats N] [--languages A,B]
                       [--write DOCUMENT] SCENE

SCENE is a file of `kiwami build`. Needs a build with tests (default: build/release). The figure is
the speed of the language over that of C: medians of the rounds of one process (the first of which
only warms up), and of the repeats. --write also puts the table under the document's heading
"Speed", in place of the one that is there.
"""

import argparse
import os
import pathlib
import statistics
import subprocess
import sys

import numpy as np

BINDINGS = pathlib.Path(__file__).resolve().parents[1]
JNA = "/usr/share/java/jna.jar"


def commands(build):
    """The program of each language, without its arguments."""
    there = build / "bindings"
    return {
        "C": [there / "benchmark" / "trace_file"],
        "C++": [there / "cpp" / "trace_file"],
        "Python": ["/usr/bin/python3", BINDINGS / "python" / "benchmarks" / "trace_file.py"],
        "Rust": [there / "rust" / "target" / "release" / "examples" / "trace_file"],
        "C#": ["mono", there / "csharp" / "TraceFile.exe"],
        "Go": [there / "go" / "trace_file"],
        "Java": ["java", "-cp", f"{there}/java/bench:{there}/java/classes:{JNA}", "TraceFile"],
        "Node": ["node", BINDINGS / "node" / "benchmark" / "trace_file.js"],
        "Lua": ["luajit", BINDINGS / "lua" / "benchmark" / "trace_file.lua"],
    }


def environment(build):
    there = build / "bindings"
    return {
        **os.environ,
        "KIWAMI_LIBRARY": str(build / "src" / "libkiwami.so.0"),
        "LD_LIBRARY_PATH": str(build / "src"),
        "PYTHONPATH": str(BINDINGS / "python"),
        "NODE_PATH": str(build / "npm" / "node" / "node_modules"),
        "KIWAMI_FFI_HEADER": str(there / "lua" / "kiwami_ffi.h"),
        "LUA_PATH": f"{BINDINGS}/lua/?.lua;;",
    }


def write_rays(scene, path, count):
    """Random rays within the scene's box."""
    sys.path.insert(0, str(BINDINGS / "python"))
    import kiwami

    bounds = kiwami.Scene.load(scene, map=True, trusted=True).bounds
    random = np.random.default_rng(1)
    kiwami.make_rays(random.uniform(*bounds, (count, 3)),
                     random.standard_normal((count, 3))).tofile(path)


def seconds_of(command, arguments, variables):
    words = [*map(str, command), arguments.scene, str(arguments.ray_file), str(arguments.rounds + 1)]
    printed = subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True, env=variables)
    return statistics.median([float(line) for line in printed.stdout.split()][1:])


def write_table(document, lines):
    """Replaces the table of the section "Speed", or adds one at its end."""
    before, found, rest = document.read_text().partition("\n## Speed\n")
    if not found:
        sys.exit(f"{document} has no heading 'Speed'")
    section, next_heading, after = rest.partition("\n## ")
    text = [line for line in section.rstrip().splitlines() if not line.startswith("|")]
    section = "\n".join([*"\n".join(text).rstrip().splitlines(), "", *lines, ""])
    document.write_text(before + found + section + next_heading + after)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=BINDINGS.parent / "build" / "release")
    parser.add_argument("--rays", type=int, default=1000000)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--languages", default="")
    parser.add_argument("--write", type=pathlib.Path, metavar="DOCUMENT")
    parser.add_argument("scene", metavar="SCENE")
    arguments = parser.parse_args()
    arguments.build = arguments.build.resolve()
    variables = environment(arguments.build)
    os.environ["KIWAMI_LIBRARY"] = variables["KIWAMI_LIBRARY"]
    arguments.ray_file = arguments.build / "bindings" / "benchmark" / "rays"
    write_rays(arguments.scene, arguments.ray_file, arguments.rays)
    programs = commands(arguments.build)
    wanted = arguments.languages.split(",") if arguments.languages else list(programs)[1:]
    lines = ["| language | speed over C |", "|---|---|"]
    print("\n".join(lines))
    for language in wanted:
        ratios = [seconds_of(programs["C"], arguments, variables)
                  / seconds_of(programs[language], arguments, variables)
                  for _ in range(arguments.repeats)]
        lines.append(f"| {language} | {statistics.median(ratios):.3f} |")
        print(lines[-1], flush=True)
    arguments.ray_file.unlink()
    if arguments.write:
        write_table(arguments.write, lines)


if __name__ == "__main__":
    main()
