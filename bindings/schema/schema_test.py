# SPDX-License-Identifier: Apache-2.0
"""Tests of the schema: what it holds of the headers, and that a difference is found."""

import contextlib
import io
import pathlib
import tempfile
import unittest
from unittest import mock

import generate
import parse_headers


class Schema(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.schema = parse_headers.read_schema()

    def struct(self, name):
        return next(each for each in self.schema["structs"] if each["name"] == name)

    def test_rays_are_laid_out_as_the_compiler_does(self):
        ray = self.struct("kiwami_ray")
        self.assertEqual((ray["size"], ray["alignment"]), (48, 4))
        self.assertEqual({field["name"]: field["offset"] for field in ray["fields"]}["mask"], 36)

    def test_padding_is_counted(self):
        sizes = {}
        structs = [{"name": "padded", "fields": [
            {"name": "a", "type": "uint8_t"}, {"name": "b", "type": "double"},
            {"name": "c", "type": "uint8_t[3]"}]}]
        parse_headers.lay_out(structs, [])
        self.assertEqual([field["offset"] for field in structs[0]["fields"]], [0, 8, 16])
        self.assertEqual(structs[0]["size"], 24)
        self.assertEqual(sizes, {})

    def test_every_exported_function_is_there(self):
        exported = (parse_headers.HEADERS.parent / "src" / "kiwami.map").read_text()
        names = {line.strip().rstrip(";") for line in exported.splitlines()
                 if line.strip().startswith("kiwami_")}
        self.assertEqual({each["name"] for each in self.schema["functions"]}, names)

    def test_constants_have_their_values(self):
        constants = self.schema["constants"]
        self.assertEqual(constants["KIWAMI_INVALID_ID"], 0xFFFFFFFF)
        self.assertEqual(constants["KIWAMI_ERROR_OUT_OF_MEMORY"], -3)
        self.assertEqual(constants["KIWAMI_RAY_CULL_FRONT_FACES"], 2)
        self.assertEqual(constants["KIWAMI_MAX_COORDINATE"], 2.0**60)

    def run_in(self, folder, *arguments):
        with mock.patch.object(generate, "BINDINGS", pathlib.Path(folder)):
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                return generate.main(list(arguments)), printed.getvalue()

    def test_a_difference_is_found(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(self.run_in(folder)[0], 0)
            self.assertEqual(self.run_in(folder, "--check"), (0, ""))
            changed = pathlib.Path(folder) / "rust" / "kiwami-sys" / "src" / "lib.rs"
            changed.write_text(changed.read_text().replace("u64", "u32", 1))
            status, printed = self.run_in(folder, "--check")
            self.assertEqual(status, 1)
            self.assertIn("lib.rs differs from the headers", printed)


if __name__ == "__main__":
    unittest.main()
