"""Shows that the judge finds what is wrong: with a command that lies (this file, started as one), and with a page whose
answers are changed on their way."""

import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time


def lying(kind: str, vpost: list[str], line: list[str]) -> int:
    """The command with one fault; what is asked with all options typed, as the other side of a comparison, is right."""
    if kind == "mute" and line[0] == "lsp":
        return mute(vpost, line)
    if kind == "half" and line[0] == "watch":
        return half(vpost, line)
    if line[0] != "correct":
        os.execvp(vpost[0], [*vpost, *line])
    more = ["--config=none"] if kind == "deaf" else []
    done = subprocess.run([*vpost, *line, *more], capture_output=True, text=True, check=False)
    errors, status = done.stderr, done.returncode
    if "--config=none" not in line:
        if kind == "messages":
            errors = re.sub(r"^(warning|error)\[.*\n", "", errors, count=1, flags=re.M)
        errors = re.sub(r"^ *--> .*\n", "", errors, flags=re.M) if kind == "placeless" else errors
        status = 0 if kind == "status" else status
        out = next((pathlib.Path(word[9:]) for word in line if word.startswith("--output=")), pathlib.Path("none"))
        if kind == "bytes" and out.exists():
            out.write_bytes(re.sub(rb"\d(?=\D*$)", b"7", out.read_bytes(), count=1) + b" ")
    sys.stdout.write(done.stdout)
    sys.stderr.write(errors)
    return status


def mute(vpost: list[str], line: list[str]) -> int:
    """A language server that keeps to itself what it has to complain of."""
    child = subprocess.Popen([*vpost, *line], stdin=sys.stdin, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    while head := child.stdout.readline():
        child.stdout.readline()
        body = child.stdout.read(int(head.split(b":")[1]))
        if not {"error", "method"} & set(json.loads(body)) or b"publishDiagnostics" in body:
            sys.stdout.buffer.write(head + b"\r\n" + body)
            sys.stdout.flush()
    return child.wait()


def half(vpost: list[str], line: list[str]) -> int:
    """A watcher that takes what it finds at once, writes it in two, and never says why not."""
    options = [word for word in line[3:] if not word.startswith("--settle")]
    while True:
        for path in pathlib.Path("in").rglob("*.n*c"):
            made = subprocess.run([*vpost, "correct", str(path), *options], capture_output=True, check=False).stdout
            to = "out" / path.relative_to("in")
            to.parent.mkdir(parents=True, exist_ok=True)
            to.write_bytes(made[: len(made) // 2])
            time.sleep(0.02)
            to.write_bytes(made)
        time.sleep(0.1)


def main(given: argparse.Namespace) -> int:
    from common.trial import Trial, belief
    import judge
    import page
    import page_directed

    trial, vpost, given.keep, given.browser = Trial(), given.vpost, None, ["chromium"]

    def found(part: str, kind: str, count: int) -> str:
        lie = [sys.executable, "-B", os.path.abspath(__file__), kind, *vpost]
        given.count, given.vpost = count, lie if kind and kind != "half" else vpost
        given.first = 0
        done = judge.PARTS[part](given, lie) if kind == "half" else judge.PARTS[part](given)
        return "\n".join(f"{what}: {text}" for case in done for what, text in case.found)

    of_settings = {"bytes": "settings bytes", "messages": "settings messages", "status": "settings accepted",
                   "deaf": "settings", "placeless": "settings place"}
    of_lsp = {"messages": "lsp messages", "mute": "in silence: in the body"}
    asked = [("settings", 26, of_settings), ("lsp", 30, of_lsp), ("watch", 12, {"half": "watch half"})]
    if given.page and shutil.which("chromium") and shutil.which("node"):
        asked.append(("page", 6, {"bytes": "page bytes", "messages": "page messages", "status": "page status"}))
    for part, count, kinds in asked:
        right = found(part, "", count)
        for kind, what in kinds.items():
            trial.ask(what not in right or what == part, f"{part}: the command has no {what}")
            lies = found(part, kind, count)
            trial.ask(what in lies and lies != right, f"{part}: a command that is {kind} has {lies.count(what)} {what}")
    if asked[-1][0] == "page":
        ask, blind = page.Page.ask, {"kind": page.GOOD, "status": "Done.", "said": "", "found": "", "listed": []}

        def lie(self: page.Page, what: str, **how: object) -> object:
            answer = ask(self, what, **how)
            return {**answer, **blind} if what == "state" else answer

        given.vpost = vpost
        with belief(page.Page, "ask", lie):
            for case in page.campaign(given, "chromium", 0, page_directed.ALL):
                trial.ask(case.found, f"page: a page that says Done to everything is found by {case.number}")
        with tempfile.TemporaryDirectory() as folder:
            text = pathlib.Path(given.page).read_text(encoding="utf-8")
            given.page = os.path.join(folder, "vpost.html")
            pathlib.Path(given.page).write_text(text + '<img src="http://127.0.0.1:9/x.png" alt="">', encoding="utf-8")
            case, = page.campaign(given, "chromium", 0, {"told": page_directed.bad_archives})
            trial.ask("page told" in dict(case.found), "page: one that asks for a picture is found")
    else:
        print("page: not asked, it needs --page, chromium and node")
    return trial.status()


if __name__ == "__main__":
    words = sys.argv[2:]
    at = next(k for k, word in enumerate(words) if word in ("correct", "watch", "lsp"))
    sys.exit(lying(sys.argv[1], words[:at], words[at:]))
