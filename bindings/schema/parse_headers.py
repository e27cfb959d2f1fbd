# SPDX-License-Identifier: Apache-2.0
"""Reads the public headers into plain data: constants, handles, callbacks, structs, functions.

The headers are preprocessed by the C compiler and parsed by pycparser, so what is read here is what
a C compiler reads. Offsets are those of every 64-bit platform: all fields are naturally aligned.
"""

import pathlib
import re
import subprocess

from pycparser import c_ast, c_parser

HEADERS = pathlib.Path(__file__).resolve().parents[2] / "include"

SCALARS = {
    "float": 4, "double": 8, "char": 1, "unsigned char": 1, "int": 4,
    "int8_t": 1, "uint8_t": 1, "int16_t": 2, "uint16_t": 2, "int32_t": 4, "uint32_t": 4,
    "int64_t": 8, "uint64_t": 8, "size_t": 8, "kiwami_result": 4,
}


def preprocess(*options):
    """The umbrella header after the preprocessor, without what only GNU compilers know."""
    hide = ["-D__attribute__(x)=", "-D__extension__=", "-D__inline=", "-D__restrict=",
            "-D__asm__(x)="]
    command = ["cc", "-E", "-std=c99", *options, *hide, f"-I{HEADERS}",
               str(HEADERS / "kiwami" / "kiwami.h")]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def macro_constants():
    """The object-like macros with a number for a value; names of the platform's are left out."""
    own = re.compile(r"#define (KIWAMI_[A-Z0-9_]+) (-?(?:0x[0-9A-Fa-f]+|[0-9.]+)[uUfF]*)\s*$", re.M)
    constants = {}
    for name, text in sorted(own.findall(preprocess("-dM"))):
        if text.lower().startswith("0x"):
            constants[name] = int(text.rstrip("uU"), 16)
        elif "." in text:
            constants[name] = float(text.rstrip("fF"))
        else:
            constants[name] = int(text.rstrip("uU"))
    return constants


def evaluate(node, known):
    """The value of a constant expression of an enum."""
    if isinstance(node, c_ast.Constant):
        return int(node.value.rstrip("uUlL"), 0)
    if isinstance(node, c_ast.ID):
        return known[node.name]
    if isinstance(node, c_ast.UnaryOp):
        value = evaluate(node.expr, known)
        return {"-": -value, "+": value, "~": ~value}[node.op]
    left, right = evaluate(node.left, known), evaluate(node.right, known)
    return {"<<": left << right, "|": left | right, "+": left + right, "-": left - right,
            "*": left * right}[node.op]


def type_of(node):
    """A C type as text: 'const kiwami_ray*', 'float[3]'."""
    if isinstance(node, c_ast.PtrDecl):
        inner = node.type
        if isinstance(inner, c_ast.FuncDecl):
            raise ValueError("a function pointer needs a name of its own (typedef)")
        return type_of(inner) + "*" + (" const" if "const" in node.quals else "")
    if isinstance(node, c_ast.ArrayDecl):
        return f"{type_of(node.type)}[{evaluate(node.dim, MACROS)}]"
    if isinstance(node, c_ast.TypeDecl):
        prefix = "const " if "const" in node.quals else ""
        if isinstance(node.type, c_ast.IdentifierType):
            return prefix + " ".join(node.type.names)
        return prefix + node.type.name
    raise ValueError(f"a type that no other language could be given: {type(node).__name__}")


def parameters_of(function):
    parameters = []
    for each in function.args.params if function.args else []:
        kind = type_of(each.type)
        if kind != "void":
            parameters.append({"name": each.name, "type": kind})
    return parameters


class Reader(c_ast.NodeVisitor):
    """Collects what begins with kiwami_."""

    def __init__(self):
        self.constants, self.handles, self.callbacks = dict(MACROS), [], []
        self.structs, self.functions = [], []

    def visit_Enum(self, node):
        value = -1
        for each in node.values.enumerators if node.values else []:
            value = evaluate(each.value, self.constants) if each.value else value + 1
            if each.name.startswith("KIWAMI_"):
                self.constants[each.name] = value

    def visit_Typedef(self, node):
        self.generic_visit(node)
        if not node.name.startswith("kiwami_"):
            return
        kind = node.type
        if isinstance(kind, c_ast.PtrDecl) and isinstance(kind.type, c_ast.FuncDecl):
            self.callbacks.append({"name": node.name, "returns": type_of(kind.type.type),
                                   "parameters": parameters_of(kind.type)})
        elif isinstance(kind, c_ast.FuncDecl):
            self.callbacks.append({"name": node.name, "returns": type_of(kind.type),
                                   "parameters": parameters_of(kind)})
        elif isinstance(kind.type, c_ast.Struct):
            if kind.type.decls is None:
                self.handles.append(node.name)
            else:
                self.structs.append({"name": node.name, "fields": [
                    {"name": field.name, "type": type_of(field.type)}
                    for field in kind.type.decls]})

    def visit_Decl(self, node):
        self.generic_visit(node)
        if node.name and node.name.startswith("kiwami_") and isinstance(node.type, c_ast.FuncDecl):
            self.functions.append({"name": node.name, "returns": type_of(node.type.type),
                                   "parameters": parameters_of(node.type)})


def measure(kind, sizes):
    """Bytes and alignment of a type."""
    array = re.fullmatch(r"(.*?)((?:\[\d+\])+)", kind)
    if array:
        size, alignment = measure(array[1], sizes)
        for count in re.findall(r"\d+", array[2]):
            size *= int(count)
        return size, alignment
    if kind.endswith("*"):
        return 8, 8
    kind = kind.removeprefix("const ")
    if kind in SCALARS:
        return SCALARS[kind], SCALARS[kind]
    return sizes[kind]


def lay_out(structs, callbacks):
    """Adds offsets and sizes."""
    sizes = {callback["name"]: (8, 8) for callback in callbacks}
    for struct in structs:
        offset, largest = 0, 1
        for field in struct["fields"]:
            size, alignment = measure(field["type"], sizes)
            offset = -(-offset // alignment) * alignment
            field["offset"] = offset
            offset += size
            largest = max(largest, alignment)
        struct["size"] = -(-offset // largest) * largest
        struct["alignment"] = largest
        sizes[struct["name"]] = (struct["size"], largest)


MACROS = macro_constants()


def read_schema():
    reader = Reader()
    # Line markers are left out: '#' begins nothing that pycparser would need.
    source = re.sub(r"^#.*$", "", preprocess(), flags=re.M)
    reader.visit(c_parser.CParser().parse(source))
    lay_out(reader.structs, reader.callbacks)
    return {"constants": reader.constants, "handles": sorted(set(reader.handles)),
            "callbacks": reader.callbacks, "structs": reader.structs,
            "functions": reader.functions}
