#!/usr/bin/env python3
"""Whether docs/testing.md says the truth of the judges: that each is listed, and which share more than plumbing.

    /usr/bin/python3 tests/judges/shared.py

Shared is what one judge takes from another's folder, and what stands in two of them all but word for word (functions of
TOKENS and more, alike by ALIKE). Each such pair needs a row under "Who shares what" that names both judges and what is
shared. Exit status 1 where a row is missing, or one is there that nothing needs.
"""

import ast
import collections
import difflib
import io
import itertools
import pathlib
import re
import sys
import tokenize

HERE = pathlib.Path(__file__).resolve().parent
PAGE = HERE.parents[1] / "docs" / "testing.md"
TOKENS, ALIKE = 60, 0.85
# What a judge is made of: command lines, loops over cases, texts of programs. Such things decide nothing.
PLUMBING = {"main", "one", "run"}


def judges() -> list[str]:
    return sorted(path.parent.name for path in HERE.glob("*/judge.py"))


def tokens(function: ast.FunctionDef) -> list[str]:
    """Of a function's body, docstring and layout apart."""
    body = function.body[isinstance(function.body[0], ast.Expr) and isinstance(function.body[0].value, ast.Constant) :]
    text = "\n".join(map(ast.unparse, body)) + "\n"
    return [token.string for token in tokenize.generate_tokens(io.StringIO(text).readline) if token.string.strip()]


def alike(one: list[str], two: list[str]) -> bool:
    if not ALIKE / (2 - ALIKE) <= len(one) / len(two) <= (2 - ALIKE) / ALIKE:
        return False
    common = sum((collections.Counter(one) & collections.Counter(two)).values())
    if 2 * common < ALIKE * (len(one) + len(two)):
        return False
    return difflib.SequenceMatcher(None, one, two, autojunk=False).ratio() >= ALIKE


def copied(trees: dict[str, list[ast.Module]]) -> set[tuple[str, str, str]]:
    """(judge, judge, function) of functions that stand in both."""
    found = [
        (judge, node.name, tokens(node))
        for judge, modules in trees.items()
        for module in modules
        for node in ast.walk(module)
        if isinstance(node, ast.FunctionDef) and node.name not in PLUMBING
    ]
    found = [one for one in found if len(one[2]) >= TOKENS]
    pairs = ((a, b) for a, b in itertools.combinations(found, 2) if a[0] != b[0])
    return {(*sorted((a[0], b[0])), a[1]) for a, b in pairs if alike(a[2], b[2])}


def taken(trees: dict[str, list[ast.Module]]) -> set[tuple[str, str]]:
    """(judge, judge) where the first names the second's folder in its code."""
    found = set()
    for judge, modules in trees.items():
        for node in itertools.chain.from_iterable(map(ast.walk, modules)):
            # `path / "shop"`, and `load("damage", …)` of `same_bytes`.
            name = node.right if isinstance(node, ast.BinOp) else None
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "load" and node.args:
                name = node.args[0]
            if isinstance(name, ast.Constant) and name.value in trees and name.value != judge:
                found.add((judge, name.value))
    return found


def section(page: str, title: str) -> str:
    return page.split(f"## {title}\n")[1].split("\n## ")[0]


def rows(text: str) -> list[tuple[set[str], str]]:
    """Judges of the first cell of each row, and the row."""
    lines = [line for line in text.splitlines() if line.startswith("| `")]
    return [(set(re.findall(r"`(\w+)`", line.split("|")[1])), line) for line in lines]


def main() -> int:
    page = PAGE.read_text(encoding="utf-8")
    listed = set().union(*(names for names, _ in rows(section(page, "Outside judges"))))
    wrong = [f"`{judge}` is not in the table" for judge in judges() if judge not in listed]
    wrong += [f"`{judge}` has no command" for judge in judges() if f"tests/judges/{judge}/judge.py" not in page]
    wrong += [f"`{name}` is listed and not there" for name in listed - set(judges())]
    files = {judge: sorted((HERE / judge).glob("*.py")) for judge in judges()}
    trees = {judge: [ast.parse(path.read_text(encoding="utf-8")) for path in paths] for judge, paths in files.items()}
    said = rows(section(page, "Who shares what"))
    needed = [({a, b}, f"`{f}`", f"`{f}` stands in `{a}` and in `{b}`") for a, b, f in sorted(copied(trees))]
    needed += [({a, b}, "", f"`{a}` takes from `{b}`") for a, b in sorted(taken(trees))]
    fits = lambda row, pair, name: pair <= row[0] and name in row[1]  # noqa: E731
    wrong += [f"not said: {text}" for pair, name, text in needed if not any(fits(row, pair, name) for row in said)]
    wrong += [f"nothing needs: {row[1]}" for row in said if not any(fits(row, pair, name) for pair, name, _ in needed)]
    for text in wrong:
        print(f"docs/testing.md: {text}")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
