# SPDX-License-Identifier: Apache-2.0
"""The scripts of the benchmarks folder, fed with builds whose figures are known."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

FOLDER = None

# A stand-in for `kiwami bench`: writes rows with given figures.
COMMAND = """#!%s
import json, sys
arguments = sys.argv[1:]
assert arguments[0] == "bench" and "--vs" in arguments, arguments
if "--fail" in arguments:
    sys.exit("kiwami: it fails")
with open(arguments[arguments.index("--json") + 1], "w") as file:
    json.dump(%r, file)
"""


def rows(speed, hits_hash="00"):
    case = {"scene": "a.tri.gz", "triangles": 1500, "threads": 1, "isa": "avx2", "width": 8}
    build = {**case, "build_ms": 2.0 / speed, "bytes_per_triangle": 50.0}
    traces = [{**case, "rays": rays, "api": api, "mrays": 3.0 * speed, "ratio": 0.9 + speed / 10,
               "hits_hash": hits_hash, "peer": "Embree"}
              for api in ("single", "batch") for rays in ("primary", "ao")]
    return [build, *traces]


def run(script, *arguments):
    return subprocess.run([sys.executable, os.path.join(FOLDER, script), *arguments],
                          capture_output=True, text=True)


class TemporaryFolderTest(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = holder.name

    def expect_failure(self, result, word):
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(word, result.stderr)
        self.assertNotIn("Traceback", result.stderr)


class CompareTest(TemporaryFolderTest):
    def build(self, name, content):
        path = os.path.join(self.folder, name, "tools", "kiwami")
        os.makedirs(path)
        command = os.path.join(path, "kiwami")
        with open(command, "w", encoding="utf-8") as file:
            file.write(COMMAND % (sys.executable, content))
        os.chmod(command, 0o755)
        return os.path.join(self.folder, name)

    def compare(self, b, *arguments):
        a = self.build("a", rows(1.0))
        return run("compare", "--repeats", "2", a, self.build("b", b), "scene", *arguments)

    def test_equal_builds_pass(self):
        result = self.compare(rows(1.0))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("geometric mean of 4 tracing ratios: 1.000", result.stdout)

    def test_a_little_slower_passes(self):
        self.assertEqual(self.compare(rows(0.975)).returncode, 0)

    def test_much_slower_fails(self):
        result = self.compare(rows(0.96))
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("0.960", result.stdout)

    def test_faster_is_above_one(self):
        result = self.compare(rows(1.5))
        self.assertEqual(result.returncode, 0)
        self.assertIn("build, 1 threads, avx2 8 wide: 1.500", result.stdout)
        self.assertIn("geometric mean of 4 tracing ratios: 1.500", result.stdout)

    def test_other_answers_fail(self):
        result = self.compare(rows(2.0, "01"))
        self.assertEqual(result.returncode, 1)
        self.assertIn("ANSWERS DIFFER", result.stdout)

    def test_nothing_in_common(self):
        self.expect_failure(self.compare([]), "no case in common")

    def test_a_failing_command_is_named(self):
        self.expect_failure(self.compare(rows(1.0), "--fail"), "it fails")

    def test_wrong_arguments(self):
        self.expect_failure(run("compare"), "expected A, B")
        self.expect_failure(run("compare", "--repeats", "0", "a", "b", "c"), "--repeats")
        self.expect_failure(run("compare", "no-such-thing", "b", "c"), "no-such-thing")
        self.expect_failure(run("compare", self.folder, self.folder, "c"), "no command")


class PlotTest(TemporaryFolderTest):
    def plot(self, content):
        source = os.path.join(self.folder, "rows.json")
        with open(source, "w", encoding="utf-8") as file:
            file.write(content)
        self.output = os.path.join(self.folder, "images", "plot.svg")
        return run("plot", source, "-o", self.output)

    def test_each_ratio_is_a_bar(self):
        result = self.plot(json.dumps(rows(1.0) + rows(5.0)))
        self.assertEqual(result.returncode, 0, result.stderr)
        picture = xml.etree.ElementTree.parse(self.output).getroot()
        texts = [element.text for element in picture.iter("{http://www.w3.org/2000/svg}text")]
        self.assertEqual(texts.count("1.00"), 4)
        self.assertEqual(texts.count("1.40"), 4)
        self.assertIn("a (2 k)", texts)
        self.assertTrue(any("batch, 1 thread, avx2 8 wide: geometric mean 1.18" == text
                            for text in texts), texts)

    def test_nothing_to_plot(self):
        self.expect_failure(self.plot("[]"), "no rows")
        self.expect_failure(self.plot("{}"), "not an array")
        self.expect_failure(self.plot("no json"), "cannot read")
        self.expect_failure(run("plot"), "expected")


class ScalingTest(TemporaryFolderTest):
    def rows(self, triangles):
        case = {"scene": "terrain", "triangles": triangles, "isa": "avx2", "width": 8}
        result = []
        for threads in (1, 2):
            result.append({**case, "threads": threads, "build_ms": triangles * 2e-4 / threads})
            result += [{**case, "threads": threads, "rays": rays, "mrays": 5.0 * threads}
                       for rays in ("bounce_shuffled", "ao")]
        return result

    def scaling(self, *arguments):
        self.output = os.path.join(self.folder, "images", "scaling.svg")
        return run("scaling", *arguments, "-o", self.output)

    def picture(self):
        return xml.etree.ElementTree.parse(self.output).getroot()

    def test_each_kind_of_ray_and_each_build_is_a_curve(self):
        source = os.path.join(self.folder, "rows.json")
        with open(source, "w", encoding="utf-8") as file:
            json.dump(self.rows(1000000) + self.rows(10000) + self.rows(100000), file)
        result = self.scaling(source)
        self.assertEqual(result.returncode, 0, result.stderr)
        curves = list(self.picture().iter("{http://www.w3.org/2000/svg}polyline"))
        self.assertEqual(len(curves), 6)
        for curve in curves:
            points = [point.split(",") for point in curve.get("points").split()]
            self.assertEqual(len(points), 3)
            across = [float(x) for x, _ in points]
            self.assertAlmostEqual(across[1] - across[0], across[2] - across[1], delta=0.2)
            self.assertEqual(len({y for _, y in points}), 1, points)
        texts = [text.text for text in self.picture().iter("{http://www.w3.org/2000/svg}text")]
        for text in ("ao, 2 threads", "1 thread", "10 k", "1.0 M", "200 ns"):
            self.assertIn(text, texts)

    def test_a_build_is_measured_at_each_count(self):
        folder = os.path.join(self.folder, "build", "tools", "kiwami")
        os.makedirs(folder)
        command = os.path.join(folder, "kiwami")
        with open(command, "w", encoding="utf-8") as file:
            file.write(COMMAND % (sys.executable, self.rows(10000)))
        os.chmod(command, 0o755)
        rows = os.path.join(self.folder, "rows.json")
        result = self.scaling(os.path.join(self.folder, "build"), "--up-to", "100000", "--json",
                              rows)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr.split("\n")[:3],
                         ["10000 triangles", "30000 triangles", "100000 triangles"])
        with open(rows, encoding="utf-8") as file:
            self.assertEqual(len(json.load(file)), 18)

    def test_nothing_to_plot(self):
        empty = os.path.join(self.folder, "empty.json")
        with open(empty, "w", encoding="utf-8") as file:
            file.write("[]")
        self.expect_failure(self.scaling(empty), "not an array of rows")
        self.expect_failure(self.scaling(self.folder), "no command")
        self.expect_failure(self.scaling(os.path.join(self.folder, "none")), "cannot read")
        self.expect_failure(run("scaling"), "BUILD")


if __name__ == "__main__":
    FOLDER = sys.argv.pop(1)
    unittest.main()
