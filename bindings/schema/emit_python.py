# SPDX-License-Identifier: Apache-2.0
"""The raw layer of Python: ctypes structures, constants and signatures.

Every pointer argument is c_void_p, which takes addresses of arrays, byref() and None alike.
"""

import re

SCALARS = {
    "float": "c_float", "double": "c_double", "char": "c_char", "int8_t": "c_int8",
    "uint8_t": "c_uint8", "int16_t": "c_int16", "uint16_t": "c_uint16", "int32_t": "c_int32",
    "uint32_t": "c_uint32", "int64_t": "c_int64", "uint64_t": "c_uint64", "size_t": "c_size_t",
    "kiwami_result": "c_int32", "void": "None",
}


def type_of(kind, callbacks, is_result=False):
    array = re.fullmatch(r"(.*?)\[(\d+)\]", kind)
    if array:
        return f"{type_of(array[1], callbacks)} * {array[2]}"
    if kind == "const char*" and is_result:
        return "ctypes.c_char_p"
    if kind.endswith("*") or kind.endswith("* const"):
        return "ctypes.c_void_p"
    kind = kind.removeprefix("const ")
    if kind in callbacks:
        # As an address, so that NULL can be given.
        return "ctypes.c_void_p"
    scalar = SCALARS.get(kind)
    return kind if scalar is None else scalar if scalar == "None" else f"ctypes.{scalar}"


def wrapped(start, items, close):
    """A list after its opening bracket, one item a line where they do not fit in one."""
    line = start + ", ".join(items) + close
    if len(line) <= 98:
        return line
    indent = " " * (len(start) - len(start.lstrip()))
    return start + "\n" + "".join(f"{indent}    {item},\n" for item in items) + indent + close


def emit(schema):
    callbacks = {callback["name"] for callback in schema["callbacks"]}
    lines = ["# SPDX-License-Identifier: Apache-2.0",
             '"""The C interface for ctypes. Generated from the headers by bindings/schema/generate.py;',
             'do not edit."""', "", "import ctypes", ""]
    lines += [f"{name} = {value!r}" for name, value in schema["constants"].items()]
    for callback in schema["callbacks"]:
        kinds = [type_of(callback["returns"], callbacks)]
        kinds += [type_of(each["type"], callbacks) for each in callback["parameters"]]
        lines += ["", wrapped(f"{callback['name']} = ctypes.CFUNCTYPE(", kinds, ")")]
    for struct in schema["structs"]:
        lines += ["", "", f"class {struct['name']}(ctypes.Structure):", "    _fields_ = ["]
        lines += [f'        ("{field["name"]}", {type_of(field["type"], callbacks)}),'
                  for field in struct["fields"]]
        lines += ["    ]"]
    lines += ["", "", "SIZES = {"]
    lines += [f'    {struct["name"]}: {struct["size"]},' for struct in schema["structs"]]
    lines += ["}", "", "", "def declare(library):",
              '    """Gives the functions of a loaded library their signatures."""']
    for function in schema["functions"]:
        kinds = [type_of(each["type"], callbacks) for each in function["parameters"]]
        name = f"    library.{function['name']}"
        lines += [f"{name}.restype = {type_of(function['returns'], callbacks, True)}",
                  wrapped(f"{name}.argtypes = [", kinds, "]")]
    return "\n".join(lines) + "\n"
