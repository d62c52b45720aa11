#!/usr/bin/env python3
"""Judge of what people use who have no terminal: the page, the watched folder, settings above a program, the editor.

    /usr/bin/python3 -B tests/judges/alone/judge.py --vpost target/release/vpost --page target/page/vpost.html

From docs/how-to/page.md, watch.md, settings.md and editor.md alone: each is held against `vpost correct` with the same
options. `--count`: programs of the page for each browser, saves, calls with settings, edits. The page needs Node.js,
Chromium and Firefox ESR; where one is missing, or no page is named, that is said. Status 1 where something is wrong.
"""

import argparse
import collections
import os
import pathlib
import random
import shutil
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))

from common import cases, folders, options  # noqa: E402
from common.cases import Case  # noqa: E402

import lsp  # noqa: E402
import page  # noqa: E402
import page_directed  # noqa: E402
import settings  # noqa: E402
import watch  # noqa: E402

BROWSERS = {"chromium": "chromium", "firefox": "firefox-esr"}


def of_page(given: argparse.Namespace) -> list[Case]:
    done = []
    for browser in given.browser or BROWSERS if given.page else ():
        if shutil.which(BROWSERS[browser]) and shutil.which("node"):
            done += page.campaign(given, browser, given.count, page_directed.ALL)
        else:
            print(f"page: skipped, {BROWSERS[browser]} or node is not here")
            done.append(Case(given, browser, folders.of_findings(None, "missing-")))
            if os.environ.get("CI"):
                done[-1].find("page missing", browser)
    if not given.page:
        print("page: skipped, none is named (--page)")
    return done


def of_settings(given: argparse.Namespace) -> list[Case]:
    done = []
    for number in cases.asked(given):
        with tempfile.TemporaryDirectory() as folder:
            done.append(Case(given, f"settings-{number}", folder))
            settings.one(done[-1], random.Random(f"settings {given.seed} {number}"))
    return done


PARTS = {"page": of_page, "watch": watch.campaign, "settings": of_settings, "lsp": lsp.campaign}


def told(done: list[Case]) -> int:
    """Prints what was found and counted; how much was found."""
    tally: collections.Counter[str] = collections.Counter()
    for case in done:
        for what, text in case.found:
            print(f"{what:18} {case.number!s:>14}  {text}", flush=True)
        tally.update(case.tally)
    print("\n".join(f"{count:6}  {name}" for name, count in sorted(tally.items())), flush=True)
    return sum(len(case.found) for case in done)


def main() -> int:
    words = options.parser(__doc__, 20, "first")
    words.add_argument("--page", metavar="FILE", help="vpost.html")
    words.add_argument("--browser", action="append", choices=BROWSERS, help="this one (repeatable)")
    words.add_argument("--only", action="append", choices=PARTS, help="this part (repeatable)")
    given = words.parse_args()
    given.vpost = options.command(words, given.vpost)
    if given.self_test:
        import self_test

        return self_test.main(given)
    given.keep = folders.of_findings(given.keep, "alone-")
    found = sum(told(PARTS[name](given)) for name in given.only or PARTS)
    print(f"{found} found, kept in {given.keep}" if found else "nothing found")
    return int(found > 0)


if __name__ == "__main__":
    sys.exit(main())
