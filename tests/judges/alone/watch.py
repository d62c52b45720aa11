"""The watched folder: random saves, slow writers, renames, deletions, a profile that breaks and is mended; what OUT
holds at each moment and at rest, beside what `vpost correct` makes of the same programs."""

import argparse
import itertools
import os
import pathlib
import random
import shutil
import signal
import subprocess
import tempfile
import threading
import time

import jobs
from common.cases import Case
from common.command import code, short

NAMES = ("a.nc", "b.nc", "Деталь 1.nc", "d.ngc", "sub/e.nc")
DECOYS = ("a.nc~", ".b.nc", "c.nc.tmp", "notes.txt", "sub/.e.nc.swp")
OPTIONS: jobs.Options = {"dialect": ["linuxcnc"], "tolerance": ["5"]}
SETTLE_S, REST_S, PATIENCE_S = 0.6, 1.5, 60


def read(path: pathlib.Path) -> bytes | None:
    try:
        return path.read_bytes()
    except OSError:
        return None


class Shop:
    """Folders IN and OUT, the command that watches, and a thread that looks into OUT all the time."""

    def __init__(self, vpost: list[str], root: pathlib.Path, rng: random.Random, watcher: list[str] | None = None):
        self.vpost, self.watched_by, self.root, self.rng = vpost, watcher or vpost, root, rng
        self.inside, self.out, self.profile = root / "in", root / "out", root / "machine/mill.toml"
        root.mkdir()
        jobs.profile(rng, root, "machine/mill.toml")
        self.inside.mkdir()
        shutil.copytree(root / "machine", root / "asked/machine")
        self.good = self.profile.read_bytes()
        self.profiles, self.saved, self.seen, self.known = [self.good], {}, set(), {}
        self.stop, self.looker = threading.Event(), threading.Thread(target=self.look, daemon=True)
        self.looker.start()
        self.watcher = self.start()

    def start(self) -> subprocess.Popen:
        line = [*self.watched_by, "watch", "in", "out", "--machine=machine/mill.toml", f"--settle={SETTLE_S}"]
        with (self.root / "watch.log").open("ab") as log:
            return subprocess.Popen([*line, *jobs.words(OPTIONS), "--lang=en"], cwd=self.root, stdout=log, stderr=log)

    def made(self) -> dict[str, bytes]:
        """What is in OUT, the command's own hidden files apart."""
        paths = [pathlib.Path(folder, name) for folder, _, names in os.walk(self.out) for name in names
                 if ".vpost" not in f"{folder}/{name}"]
        return {str(path.relative_to(self.out)): bytes_ for path in paths if (bytes_ := read(path)) is not None}

    def look(self) -> None:
        while not self.stop.is_set():
            self.seen.update(self.made().items())
            time.sleep(0.003)

    def correct(self, name: str, text: bytes, machine: bytes) -> tuple[int, bytes, str]:
        """(status, program, messages) of the command, asked once."""
        key = name, text, machine
        if key not in self.known:
            asked = jobs.Job(self.root / "asked", f"in/{name}", "machine/mill.toml", [], OPTIONS)
            asked.path(asked.program).parent.mkdir(parents=True, exist_ok=True)
            asked.path(asked.program).write_bytes(text)
            asked.path(asked.profile).write_bytes(machine)
            ended, program, _ = jobs.correct(self.vpost, asked)
            self.known[key] = ended.status, program, ended.errors
        return self.known[key]

    def save(self, name: str) -> None:
        text, path = jobs.program(self.rng, 0.25, self.rng.choice((12, 12, 3000))).encode(), self.inside / name
        self.saved.setdefault(name, set()).add(text)
        path.parent.mkdir(parents=True, exist_ok=True)
        how = self.rng.choice(("at once", "over", "slowly", "slowly", "renamed"))
        to = self.inside / "saving.tmp" if how == "renamed" else path
        with to.open("r+b" if how == "over" and path.exists() else "wb", buffering=0) as out:
            step = len(text) // (self.rng.randrange(2, 6) if how == "slowly" else 1) + 1
            for at in range(0, len(text), step):
                out.write(text[at : at + step])
                time.sleep(self.rng.uniform(0, SETTLE_S / 3) if how == "slowly" else 0)
            out.truncate()
        os.replace(to, path)

    def rename(self, name: str) -> None:
        other, text = self.rng.choice(NAMES), read(self.inside / name)
        if text is not None and other != name:
            self.saved.setdefault(other, set()).add(text)
            (self.inside / other).parent.mkdir(parents=True, exist_ok=True)
            os.replace(self.inside / name, self.inside / other)

    def spoil(self, _: str) -> None:
        self.profile.write_bytes(self.good[: self.rng.randrange(20, 90)] + b"\n[[")

    def mend(self, _: str = "") -> None:
        """With another squareness, so that everything is to be made anew."""
        before, _, after = self.good.partition(b"EC0Y_urad = ")
        self.good = b"%bEC0Y_urad = %d.5\n%b" % (before, self.rng.randrange(-90, 90), after.partition(b"\n")[2])
        self.profiles.append(self.good)
        (self.root / "mill.tmp").write_bytes(self.good)
        os.replace(self.root / "mill.tmp", self.profile)

    def again(self, _: str = "") -> None:
        """The command is killed, or asked to end, and started anew. Here and where OUT goes the profile is good:
        `with_a_broken_profile` asks for the rest."""
        self.mend()
        self.watcher.send_signal(self.rng.choice((signal.SIGKILL, signal.SIGTERM)))
        self.watcher.wait(20)
        self.watcher = self.start()

    def rob(self, _: str) -> None:
        self.mend()
        time.sleep(SETTLE_S)
        shutil.rmtree(self.out, ignore_errors=True)

    def act(self) -> str:
        acts = {
            "save": (60, self.save),
            "rename": (8, self.rename),
            "delete from IN": (6, lambda name: (self.inside / name).unlink(missing_ok=True)),
            "delete from OUT": (6, lambda name: (self.out / name).unlink(missing_ok=True)),
            "delete OUT": (2, self.rob),
            "decoy": (6, lambda _: jobs.put(self.inside, self.rng.choice(DECOYS), jobs.program(self.rng))),
            "spoil profile": (4, self.spoil),
            "mend profile": (4, self.mend),
            "kill": (4, self.again),
        }
        what = self.rng.choices(list(acts), [weight for weight, _ in acts.values()])[0]
        acts[what][1](self.rng.choice(NAMES))
        return what

    def rests(self) -> bool:
        """Waits until OUT has not changed for longer than a file takes to be whole."""
        last, since, end = None, time.monotonic(), time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            now = self.made()
            last, since = now, since if now == last else time.monotonic()
            if time.monotonic() - since > SETTLE_S + REST_S:
                return True
            time.sleep(0.1)
        return False


def whole(shop: Shop) -> list[tuple[str, str]]:
    """Contents of OUT, at any moment, that no save explains: half a file, or one of a decoy."""
    found = []
    for name, bytes_ in sorted(shop.seen):
        if name.endswith(".refused.txt"):
            fits = bytes_.endswith(b"\n")
        else:
            pairs = itertools.product(shop.saved.get(name, ()), shop.profiles)
            fits = any(shop.correct(name, text, machine)[1] == bytes_ for text, machine in pairs)
        if not fits:
            found.append(("half", f"{name} with {len(bytes_)} bytes, of no save: ends {bytes_[-40:]!r}"))
    return found


def at_rest(shop: Shop) -> list[tuple[str, str]]:
    """OUT beside IN: for each program its correction, or why there is none."""
    made, found = shop.made(), []
    if "vpost.refused.txt" in made:
        found.append(("rest", f"with a good profile: {short(made['vpost.refused.txt'].decode())}"))
    for name in NAMES:
        text, program, page = read(shop.inside / name), made.get(name), made.get(f"{name}.refused.txt", b"").decode()
        status, right, errors = shop.correct(name, text, shop.good) if text is not None else (0, program, "")
        fits = (program == right and not page) if status == 0 else code(page, "") == code(errors)
        if status and program is not None and "EARLIER" not in page.split("\n\n")[0]:
            fits = False
        if text is not None and not fits:
            found.append(("rest", f"{name}: status {status} {code(errors)}, {len(right)} bytes; in OUT "
                                  f"{'nothing' if program is None else len(program)}, page {short(page)!r}"))
    return found


def broken(case: Case, shop: Shop) -> None:
    """A profile that cannot be read is said in OUT, and nothing there goes away."""
    before = set(shop.made())
    shop.spoil("")
    end = time.monotonic() + PATIENCE_S / 3
    while "vpost.refused.txt" not in shop.made() and time.monotonic() < end:
        time.sleep(0.05)
    if lost := (before | {"vpost.refused.txt"}) - set(shop.made()):
        case.find("watch profile", f"a broken profile, and there is no {sorted(lost)}")
    shop.mend()


def check(case: Case, shop: Shop) -> None:
    shop.mend()
    for last in (False, True):
        case.tally["watch looked at rest"] += 1
        if not shop.rests():
            case.find("watch rest", f"OUT changes for more than {PATIENCE_S} s")
        for what, text in at_rest(shop):
            case.find(f"watch {what}", text)
        if shop.watcher.poll() is not None:
            log = (shop.root / "watch.log").read_text(encoding="utf-8")
            case.find("watch ended", f"{shop.watcher.returncode}: {short(log[-300:])}")
            shop.watcher = shop.start()
        if not last:
            broken(case, shop)


def with_a_broken_profile(given: argparse.Namespace, case: Case, rng: random.Random, what: str) -> None:
    """Started, or robbed of OUT, while the profile is broken; when that is mended all is corrected."""
    shop = Shop(given.vpost, case.folder / what, rng)
    shop.save("a.nc")
    shop.rests()
    shop.spoil("")
    if what == "started":
        shop.watcher.kill()
        shop.watcher = shop.start()
    time.sleep(2 * SETTLE_S)
    if what == "robbed":
        shutil.rmtree(shop.out)
        time.sleep(2 * SETTLE_S)
    shop.mend()
    shop.rests()
    for _, text in at_rest(shop):
        case.find(f"watch {what}", f"while the profile was broken, mended then; ended: {shop.watcher.poll()}; {text}")
    shop.stop.set()
    shop.watcher.kill()


def campaign(given: argparse.Namespace, watcher: list[str] | None = None) -> list[Case]:
    """As many saves as are asked for, and what happens between them; `watcher`: another command than the judged one."""
    rng, saves = random.Random(f"watch {given.seed}"), 0
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        case = Case(given, "watch", folder)
        shop = Shop(given.vpost, case.folder / "watched", rng, watcher)
        while saves < given.count:
            act = shop.act()
            case.tally[f"watch {act}"] += 1
            saves += act == "save"
            time.sleep(rng.choice((0, 0, 0.05, 0.3, SETTLE_S * 1.5)))
            if act == "save" and (saves % 20 == 0 or saves == given.count):
                check(case, shop)
        shop.stop.set()
        shop.watcher.kill()
        for what, text in whole(shop):
            case.find(f"watch {what}", text)
        if watcher is None:
            for what in ("started", "robbed"):
                with_a_broken_profile(given, case, rng, what)
    return [case]
