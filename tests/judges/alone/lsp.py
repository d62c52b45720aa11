"""The language server: random edits, and at rest the messages of `vpost correct` on the same text; what is malformed,
cancelled or cut off never ends it in silence."""

import argparse
import collections
import functools
import json
import pathlib
import queue
import random
import re
import subprocess
import tempfile
import threading
import time

import jobs
from common.cases import Case
from common.command import run, short

# Edits of one program, until the next is opened.
ANSWER_S, EDITS = 20, 30
MESSAGE = re.compile(r"^(error|warning)\[(VP\d+)\]: (.*)\n(?: *--> .+:(\d+):(\d+)$)?", re.M)


class Editor:
    """An editor's side: requests by number, the last messages of each text."""

    def __init__(self, vpost: list[str], folder: pathlib.Path, settings: dict):
        pipe = subprocess.PIPE
        self.child = subprocess.Popen([*vpost, "lsp", "--lang=en"], stdin=pipe, stdout=pipe, stderr=pipe, cwd=folder)
        self.answers, self.published = collections.defaultdict(queue.Queue), queue.Queue()
        # What it said: words on standard error, and whole messages.
        self.words, self.told, self.last = [], [], 0
        threading.Thread(target=self.read, daemon=True).start()
        threading.Thread(target=lambda: self.words.extend(self.child.stderr), daemon=True).start()
        self.ask("initialize", processId=None, rootUri=folder.as_uri(), capabilities={}, initializationOptions=settings)
        self.tell("initialized")

    def read(self) -> None:
        out = self.child.stdout
        while head := out.readline():
            length = 0
            while head.strip():
                name, _, size = head.partition(b":")
                length = int(size) if name.lower() == b"content-length" else length
                head = out.readline()
            message = json.loads(out.read(length))
            self.told.append(message)
            if message.get("method") == "textDocument/publishDiagnostics":
                self.published.put(message["params"])
            elif "method" in message and "id" in message:
                self.send({"id": message["id"], "result": None})
            else:
                self.answers[message.get("id")].put(message)

    def raw(self, bytes_: bytes) -> None:
        self.child.stdin.write(bytes_)
        self.child.stdin.flush()

    def send(self, message: dict) -> None:
        self.raw(framed(json.dumps({"jsonrpc": "2.0", **message}, ensure_ascii=False).encode()))

    def tell(self, method: str, **params: object) -> None:
        self.send({"method": method, "params": params})

    def ask(self, method: str, **params: object) -> dict | None:
        """The whole answer; None where none comes."""
        self.last += 1
        self.send({"id": self.last, "method": method, "params": params})
        try:
            return self.answers[self.last].get(timeout=ANSWER_S)
        except queue.Empty:
            return None

    def open(self, path: pathlib.Path, text: str) -> str:
        document = {"uri": path.as_uri(), "languageId": "nc", "version": 1, "text": text}
        self.tell("textDocument/didOpen", textDocument=document)
        return path.as_uri()

    def diagnostics(self, uri: str, version: int) -> list[dict] | None:
        """Of this version of a text; None where they do not come."""
        end = time.monotonic() + ANSWER_S
        while time.monotonic() < end:
            try:
                found = self.published.get(timeout=max(0.01, end - time.monotonic()))
            except queue.Empty:
                break
            if found["uri"] == uri and found.get("version") == version:
                return found["diagnostics"]
        return None


def framed(body: bytes) -> bytes:
    return b"Content-Length: %d\r\n\r\n%s" % (len(body), body)


def place(text: str, at: int) -> dict:
    """Line and UTF-16 character of a place in a text."""
    before = text[:at]
    row = before.count("\n")
    return {"line": row, "character": len(before.rsplit("\n", 1)[-1].encode("utf-16-le")) // 2}


PIECES = ("G1 X12.5 Y3. F200.\n", "G0 Z50.\n", "(деталь 😀)", "Х", "X", "1", ".", "-", "#701", "G2 X1. Y1. R0.1\n", "\n",
          "M30\n", "N10 ", "(", ")", "G91\n", "G90\n", "G43 H17\n", "IF [#1 EQ 2] GOTO 10\n", "\t", "%\n", "é",
          "G68 X0 Y0 R30\n")


def edit(rng: random.Random, text: str) -> tuple[str, dict]:
    """A change that an editor sends, and the text behind it."""
    kind = rng.choices(("anew", "in", "out", "replace", "mend"), (8, 40, 15, 15, 22))[0]
    if kind == "anew":
        text = jobs.program(rng, 0.5)
        return text, {"text": text}
    first = rng.randrange(len(text) + 1)
    last = first if kind == "in" else min(len(text), first + rng.choice((1, 1, 2, 5, 40)))
    if kind == "mend":
        first, last = text.rfind("\n", 0, first) + 1, text.find("\n", first) % (len(text) + 1)
    # Never between the two of a line's end.
    first, last = sorted(at + (text[at - 1 : at + 1] == "\r\n") for at in (first, last))
    piece = {"out": "", "mend": "G1 X5. Y5. F300."}.get(kind, rng.choice(PIECES))
    change = {"range": {"start": place(text, first), "end": place(text, last)}, "text": piece}
    return text[:first] + piece + text[last:], change


def of_command(case: Case, job: jobs.Job, text: str) -> list[tuple]:
    """(severity, number, first words, line, column) of the command's messages on this text; line 0: it has no place."""
    job.path(job.program).write_bytes(text.encode())
    line = ["correct", job.program, f"--machine={job.profile}", *jobs.words(job.options), "--lang=en"]
    errors = run(case.options.vpost, *line, folder=job.folder).errors
    found = MESSAGE.findall(errors)
    return sorted((kind, number, words, int(row or 0), int(column or 0)) for kind, number, words, row, column in found)


def of_server(text: str, diagnostics: list[dict]) -> list[tuple]:
    """The same of the server's; columns are counted in characters, as the command does."""
    lines, out = text.split("\n"), []
    for one in diagnostics:
        row, at = one["range"]["start"]["line"], one["range"]["start"]["character"]
        line = lines[row] if row < len(lines) else ""
        column = len(line.encode("utf-16-le")[: 2 * at].decode("utf-16-le", "replace")) + 1
        kind = {1: "error", 2: "warning"}.get(one["severity"], "other")
        out.append((kind, str(one.get("code")), one["message"].split("\n")[0].replace("\t", "    "), row + 1, column))
    return sorted(out)


def same(command: list[tuple], server: list[tuple]) -> bool:
    """Messages without a place of their own stand somewhere in the program."""
    rest = [one for one in server if one not in command]
    loose = [one for one in command if one not in server]
    are_loose = not any(one[3] for one in loose) and [one[:3] for one in loose] == [one[:3] for one in rest]
    return are_loose and len(command) == len(server)


def edited(case: Case, rng: random.Random, edits: int) -> None:
    job = jobs.make(rng, case.folder)
    options = {name: values if name in jobs.REPEATED else float(values[0]) if name in ("tolerance", "accept") else
               values[0] if values else True for name, values in {"machine": [job.profile], **job.options}.items()}
    editor = Editor(case.options.vpost, job.folder, {name.replace("-", "_"): some for name, some in options.items()})
    text, version = job.path(job.program).read_bytes().decode("utf-8", "ignore"), 1
    uri = editor.open(job.path(job.program), text)
    while case.tally["lsp edits"] < edits:
        changes = []
        for _ in range(rng.choice((1, 1, 2, 5))):
            text, change = edit(rng, text)
            changes.append(change)
        case.tally["lsp edits"] += len(changes)
        for some in [changes] if rng.random() < 0.5 else [[one] for one in changes]:
            version += 1
            editor.tell("textDocument/didChange", textDocument={"uri": uri, "version": version}, contentChanges=some)
            if rng.random() < 0.3:
                disturb(editor, rng, uri)
        found = editor.diagnostics(uri, version)
        if found is None:
            case.find("lsp silent", f"no messages of version {version} in {ANSWER_S} s; ended: {editor.child.poll()}")
            break
        server, command = of_server(text, found), of_command(case, job, text)
        case.tally[f"lsp texts at rest, {len({one[1] for one in command})} numbers"] += 1
        if not same(command, server):
            pairs = (server, command), (command, server)
            alone = [[one for one in some if one not in other][:3] for some, other in pairs]
            case.find("lsp messages", f"{jobs.shown(job)}: only the server {alone[0]}, only the command {alone[1]}")
    editor.ask("shutdown")
    editor.tell("exit")
    if status := editor.child.wait(ANSWER_S):
        case.find("lsp end", f"shutdown and exit, and status {status}")


def disturb(editor: Editor, rng: random.Random, uri: str) -> None:
    """Between edits: questions withdrawn, asked or not, a text that is not open, a message that nobody knows."""
    at = {"textDocument": {"uri": uri}, "position": {"line": rng.randrange(30), "character": rng.randrange(20)}}
    rng.choice((
        lambda: (editor.send({"id": f"{rng.random()}", "method": "textDocument/hover", "params": at}),
                 editor.tell("$/cancelRequest", id=editor.last)),
        lambda: editor.tell("$/cancelRequest", id=rng.choice((10**9, "nothing"))),
        lambda: editor.tell("textDocument/didChange", textDocument={"uri": "file:///no.nc"}, contentChanges=[]),
        lambda: editor.tell("no/suchThing", x=[1, None]),
    ))()


def change(first: int, last: int) -> bytes:
    """Of the text URI, lines that are not in order."""
    places = {"start": {"line": first, "character": 0}, "end": {"line": last, "character": 0}}
    params = {"textDocument": {"uri": "URI", "version": 2}, "contentChanges": [{"range": places, "text": "x"}]}
    return json.dumps({"jsonrpc": "2.0", "method": "textDocument/didChange", "params": params}).encode()


# Bodies that no editor should send, in a whole frame, so that the next message can be read.
WHOLE = {
    "not json": b"{nonsense", "an array": b"[]", "a number": b"5", "no method": b'{"jsonrpc":"2.0"}', "nothing": b"",
    "not utf-8": b'{"jsonrpc":"2.0","method":"\xff\xfe"}', "deep": b"[" * 100_000,
    "params of another kind": b'{"jsonrpc":"2.0","id":900,"method":"textDocument/hover","params":[1]}',
    "an open without a text": b'{"jsonrpc":"2.0","method":"textDocument/didOpen","params":{"textDocument":{}}}',
    "before the first line": change(-1, 0), "backwards": change(3, 1), "far behind the end": change(10**6, 10**7),
}
# What is not followed by anything that can be read.
CUT = {
    "in the head": b"Content-Len", "in the body": b'Content-Length: 50\r\n\r\n{"jsonrpc":', "no head": b"hello\r\n\r\n",
    "no length": b"Content-Type: x\r\n\r\n{}", "a word for a length": b"Content-Length: ten\r\n\r\n{}",
    "a negative length": b"Content-Length: -5\r\n\r\n{}", "a huge length": b"Content-Length: 99999999999999\r\n\r\n{}",
    "a length too short": b'Content-Length: 5\r\n\r\n{"jsonrpc":"2.0","method":"x"}', "garbage": b"\x00\xff\n\n\n",
}


def malformed(case: Case, name: str, bytes_: bytes) -> None:
    """Behind it the server answers, or it ends with a status that is not 0 and with words."""
    jobs.profile(random.Random(1), case.folder, "mill.toml")
    editor = Editor(case.options.vpost, case.folder, {"machine": "mill.toml", "dialect": "linuxcnc"})
    uri = editor.open(case.folder / "part.nc", jobs.program(random.Random(1)))
    editor.diagnostics(uri, 1)
    before, answer = len(editor.told), None
    try:
        if name in CUT:
            editor.raw(bytes_)
            editor.child.stdin.close()
        else:
            editor.raw(framed(bytes_.replace(b"URI", uri.encode())))
            answer = editor.ask("textDocument/hover", textDocument={"uri": uri}, position={"line": 8, "character": 1})
        status = None if answer else editor.child.wait(ANSWER_S)
    except (OSError, subprocess.TimeoutExpired):
        status = editor.child.poll()
    editor.child.kill()
    time.sleep(0.1)
    words = b"".join(editor.words)
    case.tally[f"lsp malformed: {'goes on' if answer else 'ends'}"] += 1
    if not answer and (status in (None, 0) or not (words or editor.told[before:])):
        case.find("lsp in silence", f"{name}, {bytes_[:60]!r}: ends with {status}, says nothing")
    if b"panicked" in words:
        case.find("lsp panic", f"{name}: {short(words.decode())}")


def campaign(given: argparse.Namespace) -> list[Case]:
    done = []
    tasks = {}
    for n in range(0, given.count, EDITS):
        rng, edits = random.Random(f"lsp {given.seed} {n}"), min(EDITS, given.count - n)
        tasks[f"lsp-{n}"] = functools.partial(edited, rng=rng, edits=edits)
    for name, bytes_ in (WHOLE | CUT).items():
        tasks[f"lsp {name}"] = functools.partial(malformed, name=name, bytes_=bytes_)
    for name, ask in tasks.items():
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
            done.append(Case(given, name, folder))
            ask(done[-1])
    return done
