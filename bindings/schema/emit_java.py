# SPDX-License-Identifier: Apache-2.0
"""The raw layer of Java: JNA direct mapping, and the offsets of all fields of all structs.

Structs are written in direct memory at these offsets, since JNA's own structures copy.
"""

SCALARS = {
    "float": "float", "double": "double", "int8_t": "byte", "uint8_t": "byte", "int16_t": "short",
    "uint16_t": "short", "int32_t": "int", "uint32_t": "int", "int64_t": "long",
    "uint64_t": "long", "size_t": "long", "kiwami_result": "int", "void": "void",
}


def type_of(kind, callbacks):
    if kind.rstrip(" const").endswith("*"):
        return "Pointer"
    kind = kind.removeprefix("const ")
    return "Callback" if kind in callbacks else SCALARS[kind]


def camel(name):
    first, *others = name.split("_")
    return first + "".join(other.capitalize() for other in others)


def constant(name, value):
    if isinstance(value, float):
        return f"  static final float {name} = {value!r}f;"
    return f"  static final int {name} = {value if value < 2**31 else hex(value)};"


def emit(schema):
    callbacks = {callback["name"] for callback in schema["callbacks"]}
    lines = ["// SPDX-License-Identifier: Apache-2.0",
             "// The C interface for JNA. Generated from the headers by",
             "// bindings/schema/generate.py; do not edit.", "package org.kiwami;", "",
             "import com.sun.jna.Callback;", "import com.sun.jna.Pointer;", "",
             "final class Native {", "  private Native() {}", ""]
    lines += [constant(*each) for each in schema["constants"].items()]
    for struct in schema["structs"]:
        name = "".join(part.capitalize() for part in struct["name"].split("_")[1:])
        lines += ["", f"  /** Offsets of {struct['name']}. */", f"  static final class {name} {{",
                  f"    static final int STRUCT_BYTES = {struct['size']};"]
        lines += [f"    static final int {field['name'].upper()} = {field['offset']};"
                  for field in struct["fields"]]
        lines += ["  }"]
    lines += ["", "  static {", "    com.sun.jna.Native.register(LibraryFile.path());", "  }"]
    for each in schema["functions"]:
        parameters = ", ".join(f"{type_of(p['type'], callbacks)} {camel(p['name'])}"
                               for p in each["parameters"])
        lines += ["", f"  static native {type_of(each['returns'], callbacks)} {each['name']}("
                  f"{parameters});"]
    return "\n".join([*lines, "}"]) + "\n"
