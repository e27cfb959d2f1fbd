# SPDX-License-Identifier: Apache-2.0
"""The crate kiwami-sys: the C interface as Rust sees it, with its layouts asserted."""

import re

SCALARS = {
    "float": "f32", "double": "f64", "char": "c_char", "int8_t": "i8", "uint8_t": "u8",
    "int16_t": "i16", "uint16_t": "u16", "int32_t": "i32", "uint32_t": "u32", "int64_t": "i64",
    "uint64_t": "u64", "size_t": "usize", "void": "c_void",
}
KEYWORDS = {"type", "ref", "in", "box", "move", "match", "where", "loop", "mod", "use"}


def type_of(kind):
    array = re.fullmatch(r"(.*?)\[(\d+)\]", kind)
    if array:
        return f"[{type_of(array[1])}; {array[2]}]"
    kind = kind.removesuffix(" const")
    if kind.endswith("*"):
        inner = kind[:-1]
        if inner.startswith("const ") and not inner.endswith("*"):
            return f"*const {type_of(inner.removeprefix('const '))}"
        return f"*mut {type_of(inner)}"
    kind = kind.removeprefix("const ")
    return SCALARS.get(kind, kind)


def name_of(name):
    return f"r#{name}" if name in KEYWORDS else name


def signature(parameters, returns):
    text = ", ".join(f"{name_of(each['name'])}: {type_of(each['type'])}" for each in parameters)
    return f"({text})" + ("" if returns == "void" else f" -> {type_of(returns)}")


def constant(name, value):
    if isinstance(value, float):
        return f"pub const {name}: f32 = {value!r};"
    is_signed = value < 0 or name == "KIWAMI_OK"
    return f"pub const {name}: {'i32' if is_signed else 'u32'} = {value};"


def emit(schema):
    lines = ["// SPDX-License-Identifier: Apache-2.0",
             "//! The C interface of Kiwami. Generated from the headers by",
             "//! bindings/schema/generate.py; do not edit. See the crate `kiwami` for a safe one.",
             "#![allow(non_camel_case_types)]", "#![cfg_attr(rustfmt, rustfmt_skip)]",
             "", "use std::os::raw::{c_char, c_void};",
             "", "pub type kiwami_result = i32;", ""]
    lines += [constant(*each) for each in schema["constants"].items()]
    for handle in schema["handles"]:
        lines += ["", "#[repr(C)]", f"pub struct {handle} {{", "    _private: [u8; 0],", "}"]
    for each in schema["callbacks"]:
        lines += ["", f"pub type {each['name']} =",
                  f"    Option<unsafe extern \"C\" fn{signature(each['parameters'], each['returns'])}>;"]
    for struct in schema["structs"]:
        lines += ["", "#[repr(C)]", "#[derive(Clone, Copy)]", f"pub struct {struct['name']} {{"]
        lines += [f"    pub {name_of(field['name'])}: {type_of(field['type'])},"
                  for field in struct["fields"]]
        lines += ["}", f"const _: () = assert!(std::mem::size_of::<{struct['name']}>() == "
                  f"{struct['size']});"]
    lines += ["", 'extern "C" {']
    lines += [f"    pub fn {each['name']}{signature(each['parameters'], each['returns'])};"
              for each in schema["functions"]]
    return "\n".join([*lines, "}"]) + "\n"
