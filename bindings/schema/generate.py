# SPDX-License-Identifier: Apache-2.0
"""Writes the schema of the C interface and the raw layers of the bindings from the headers.

  generate.py            write all files
  generate.py --check    write nothing; list the files that differ from the headers, and fail
"""

import json
import pathlib
import sys

import emit_csharp
import emit_java
import emit_node
import emit_python
import emit_rust
from parse_headers import read_schema

BINDINGS = pathlib.Path(__file__).resolve().parents[1]


def files_of(schema):
    """The text of every generated file."""
    return {
        "schema/kiwami.json": json.dumps(schema, indent=1) + "\n",
        "python/kiwami/_native.py": emit_python.emit(schema),
        "rust/kiwami-sys/src/lib.rs": emit_rust.emit(schema),
        "csharp/Kiwami/Native.cs": emit_csharp.emit(schema),
        "java/src/main/java/org/kiwami/Native.java": emit_java.emit(schema),
        "node/lib/native.js": emit_node.emit(schema),
    }


def main(arguments):
    if arguments not in ([], ["--check"]):
        print(__doc__, file=sys.stderr)
        return 2
    stale = []
    for name, text in files_of(read_schema()).items():
        path = BINDINGS / name
        if path.exists() and path.read_text() == text:
            continue
        stale.append(name)
        if not arguments:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
    for name in stale:
        print(f"{name} {'differs from the headers' if arguments else 'written'}")
    return 1 if arguments and stale else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
