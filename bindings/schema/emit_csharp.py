# SPDX-License-Identifier: Apache-2.0
"""The raw layer of C#: P/Invoke signatures and sequential structs. Pointers are IntPtr or void*."""

import re

SCALARS = {
    "float": "float", "double": "double", "char": "byte", "int8_t": "sbyte", "uint8_t": "byte",
    "int16_t": "short", "uint16_t": "ushort", "int32_t": "int", "uint32_t": "uint",
    "int64_t": "long", "uint64_t": "ulong", "size_t": "UIntPtr", "kiwami_result": "int",
    "void": "void",
}
KEYWORDS = {"params", "object", "base", "in", "out", "ref", "lock", "event", "is", "as"}


def name_of(name):
    return f"@{name}" if name in KEYWORDS else name


def type_of(kind, callbacks):
    if kind.rstrip(" const").endswith("*"):
        return "IntPtr"
    kind = kind.removeprefix("const ")
    return "IntPtr" if kind in callbacks else SCALARS.get(kind, kind)


def field(each, callbacks):
    array = re.fullmatch(r"(.*?)\[(\d+)\]", each["type"])
    if array:
        return f"public fixed {type_of(array[1], callbacks)} {name_of(each['name'])}[{array[2]}];"
    return f"public {type_of(each['type'], callbacks)} {name_of(each['name'])};"


def parameters(function, callbacks):
    return ", ".join(f"{type_of(each['type'], callbacks)} {name_of(each['name'])}"
                     for each in function["parameters"])


def constant(name, value):
    if isinstance(value, float):
        return f"public const float {name} = {value!r}f;"
    kind = "int" if value < 0 or name == "KIWAMI_OK" else "uint"
    return f"public const {kind} {name} = {value};"


def emit(schema):
    callbacks = {callback["name"] for callback in schema["callbacks"]}
    lines = ["// SPDX-License-Identifier: Apache-2.0",
             "// The C interface for P/Invoke. Generated from the headers by",
             "// bindings/schema/generate.py; do not edit.", "#pragma warning disable 649",
             "using System;", "using System.Runtime.InteropServices;", "",
             "namespace Kiwami.Interop {", ""]
    for each in schema["callbacks"]:
        lines += ["[UnmanagedFunctionPointer(CallingConvention.Cdecl)]",
                  f"internal delegate {type_of(each['returns'], callbacks)} {each['name']}("
                  f"{parameters(each, callbacks)});", ""]
    for struct in schema["structs"]:
        lines += ["[StructLayout(LayoutKind.Sequential)]",
                  f"internal unsafe struct {struct['name']} {{"]
        lines += [f"  {field(each, callbacks)}" for each in struct["fields"]]
        lines += [f"  public const int Size = {struct['size']};", "}", ""]
    lines += ["internal static class Native {", '  const string Library = "kiwami";', ""]
    lines += [f"  {constant(*each)}" for each in schema["constants"].items()]
    for each in schema["functions"]:
        lines += ["", "  [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]",
                  f"  public static extern {type_of(each['returns'], callbacks)} {each['name']}("
                  f"{parameters(each, callbacks)});"]
    return "\n".join([*lines, "}", "}"]) + "\n"
