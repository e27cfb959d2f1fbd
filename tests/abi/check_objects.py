#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks what object files and the shared library contain. Prints each finding; exits 1 on any.

  isa-symbols ISA OBJECT...     defined symbols that others can see: the ISA's one getter, and
                                what lies in its own namespace
  no-statics OBJECT...          no writable data, no code that runs at load
  no-constructors OBJECT...     no code that runs at load
  exports LIBRARY MAP HEADERS   exported symbols == those of the map == functions of the headers
"""
import argparse
import pathlib
import re
import subprocess
import sys

CONSTRUCTOR_SECTIONS = (".init_array", ".fini_array", ".ctors", ".dtors", ".preinit_array")
WRITABLE_SECTIONS = (".data", ".bss", ".tdata", ".tbss")
# Read-only after relocation: tables of constant pointers.
CONSTANT_SECTIONS = (".data.rel.ro",)


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def defined_symbols(nm, path):
    """(type, demangled name) of each defined symbol that other objects can see."""
    for line in output_of(nm, "--extern-only", "--defined-only", "-C", path).splitlines():
        fields = line.split(maxsplit=2)
        if len(fields) == 3:
            yield fields[1], fields[2]


def sections(objdump, path):
    """(name, size) of each section."""
    for line in output_of(objdump, "-h", "-w", path).splitlines():
        fields = line.split()
        if len(fields) > 2 and fields[0].isdigit():
            yield fields[1], int(fields[2], 16)


def begins_with(name, prefixes):
    return any(name == prefix or name.startswith(prefix + ".") for prefix in prefixes)


def find_isa_symbols(arguments):
    getter = f"kiwami_{arguments.isa}_kernel_table"
    own_namespace = re.compile(rf"(^|\s)kiwami::{arguments.isa}::")
    has_getter = False
    for path in arguments.objects:
        for kind, name in defined_symbols(arguments.nm, path):
            if name == getter:
                has_getter = True
            elif not own_namespace.search(name.split("(")[0]):
                yield f"{path} leaks {kind} {name}"
    if not has_getter:
        yield f"the objects of {arguments.isa} lack {getter}"


def find_sections(arguments, prefixes):
    for path in arguments.objects:
        for name, size in sections(arguments.objdump, path):
            if size and begins_with(name, prefixes) and not begins_with(name, CONSTANT_SECTIONS):
                yield f"{path} holds {size} bytes of {name}"


def find_exports(arguments):
    exported = set()
    for line in output_of(arguments.nm, "-D", "--defined-only", arguments.library).splitlines():
        kind, name = line.split()[-2:]
        name = name.split("@")[0]
        if not (kind == "A" and name.startswith("KIWAMI_")):  # the name of the version node
            exported.add(name)
    listed = set(re.findall(r"^\s+(kiwami_\w+);", pathlib.Path(arguments.map).read_text(), re.M))
    declared = set()
    for header in pathlib.Path(arguments.headers).glob("*.h"):
        declared |= set(re.findall(r"KIWAMI_API[^;(]*?\b(kiwami_\w+)\(", header.read_text()))
    yield from (f"the library exports {name}, which the map lacks" for name in exported - listed)
    yield from (f"the library does not export {name} of the map" for name in listed - exported)
    yield from (f"the map lists {name}, which no header declares" for name in listed - declared)
    yield from (f"the map lacks {name}, which a header declares" for name in declared - listed)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nm", default="nm")
    parser.add_argument("--objdump", default="objdump")
    checks = parser.add_subparsers(dest="check", required=True)
    isa_symbols = checks.add_parser("isa-symbols")
    isa_symbols.add_argument("isa")
    for check in (isa_symbols, checks.add_parser("no-statics"),
                  checks.add_parser("no-constructors")):
        check.add_argument("objects", nargs="+")
    exports = checks.add_parser("exports")
    for name in ("library", "map", "headers"):
        exports.add_argument(name)
    arguments = parser.parse_args()

    findings = {
        "isa-symbols": find_isa_symbols,
        "no-statics": lambda a: find_sections(a, CONSTRUCTOR_SECTIONS + WRITABLE_SECTIONS),
        "no-constructors": lambda a: find_sections(a, CONSTRUCTOR_SECTIONS),
        "exports": find_exports,
    }[arguments.check](arguments)
    count = 0
    for finding in sorted(findings):
        print(finding)
        count += 1
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
