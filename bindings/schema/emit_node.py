# SPDX-License-Identifier: Apache-2.0
"""The raw layer of Node: what koffi is told of the C interface.

Arguments are void pointers: batches are typed arrays, and structs are encoded by the caller.
"""

import re

SCALARS = {"kiwami_result": "int32_t"}


def type_of(kind, callbacks):
    if kind == "const char*":
        return "const char *"
    if kind.rstrip(" const").endswith("*"):
        return "void *"
    kind = kind.removeprefix("const ")
    return "void *" if kind in callbacks else SCALARS.get(kind, kind)


def field_type(kind, callbacks):
    array = re.fullmatch(r"(.*?)\[(\d+)\]", kind)
    if array:
        return f"{type_of(array[1], callbacks)} [{array[2]}]"
    return type_of(kind, callbacks)


def prototype(function, callbacks):
    # Text that the callee writes is a buffer, not a string.
    parameters = ", ".join(
        f"{'void *' if '*' in each['type'] else type_of(each['type'], callbacks)} {each['name']}"
        for each in function["parameters"])
    return f"{type_of(function['returns'], callbacks)} {function['name']}({parameters or 'void'})"


def emit(schema):
    callbacks = {callback["name"] for callback in schema["callbacks"]}
    lines = ["// SPDX-License-Identifier: Apache-2.0",
             "// The C interface for koffi. Generated from the headers by",
             "// bindings/schema/generate.py; do not edit.", "'use strict';", "",
             "exports.constants = {"]
    lines += [f"  {name}: {value!r}," for name, value in schema["constants"].items()]
    lines += ["};", "", "exports.callbacks = ["]
    lines += [f"  '{prototype(each, callbacks)}'," for each in schema["callbacks"]]
    lines += ["];", "", "exports.functions = ["]
    lines += [f"  '{prototype(each, callbacks)}'," for each in schema["functions"]]
    lines += ["];", "", "exports.structs = {"]
    for struct in schema["structs"]:
        lines += [f"  {struct['name']}: {{", f"    size: {struct['size']},", "    fields: {"]
        lines += [f"      {field['name']}: '{field_type(field['type'], callbacks)}',"
                  for field in struct["fields"]]
        lines += ["    },", "  },"]
    return "\n".join([*lines, "};"]) + "\n"
