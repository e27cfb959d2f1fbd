# SPDX-License-Identifier: Apache-2.0
"""The table of languages and features, made of what the tests of the bindings found right.

  feature_table.py FOLDER DOCUMENT            write the table into the document
  feature_table.py --check FOLDER DOCUMENT    fail if the document says anything else

FOLDER has a file for each test, in which it lists features; a language whose file is missing was not
tested here, and its row stays as it is.
"""

import pathlib
import sys

LANGUAGES = {"cpp": "C++", "python": "Python", "rust": "Rust", "csharp": "C#", "go": "Go",
             "java": "Java", "node": "Node", "lua": "Lua"}
FEATURES = ["closest hit", "any hit", "multi hit", "counts", "fields apart", "errors", "files",
            "changes, refit", "spheres, discs, curves", "moving meshes", "instances",
            "progress callback", "filter callback", "user geometry callback", "many lights"]
BEGIN, END = "<!-- features: made by bindings/feature_table.py -->", "<!-- end of features -->"


def row_of(folder, language):
    """The row of a language, or None where it was not tested."""
    path = folder / f"{language}.txt"
    if not path.exists():
        return None
    found = set(path.read_text().splitlines())
    unknown = found - set(FEATURES)
    if unknown:
        sys.exit(f"{path} has {', '.join(sorted(unknown))}, expected some of FEATURES")
    cells = ["yes" if feature in found else "" for feature in FEATURES]
    return f"| {LANGUAGES[language]} | " + " | ".join(cells) + " |"


def main(arguments):
    is_check = arguments[0] == "--check"
    folder, document = (pathlib.Path(each) for each in arguments[-2:])
    text = document.read_text()
    before, rest = text.split(BEGIN)
    old, after = rest.split(END)
    old_rows = {line.split("|")[1].strip(): line for line in old.splitlines() if "|" in line}
    rows = [f"| language | {' | '.join(FEATURES)} |", "|---" * (len(FEATURES) + 1) + "|"]
    for language, name in LANGUAGES.items():
        rows.append(row_of(folder, language) or old_rows.get(name, f"| {name} |"))
    made = before + BEGIN + "\n\n" + "\n".join(rows) + "\n\n" + END + after
    if is_check and made != text:
        print(f"{document} differs from what the tests found:\n" + "\n".join(rows))
        return 1
    if not is_check:
        document.write_text(made)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
