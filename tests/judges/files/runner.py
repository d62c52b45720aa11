"""What all checks of this judge share: running the command under limits, making programs and profiles, keeping reproducers."""

import collections
import os
import random
import resource
import shlex
import shutil
import signal
import subprocess
import tempfile
import threading
import time

REPOSITORY = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
ABORTS = (-signal.SIGABRT, -signal.SIGSEGV, -signal.SIGBUS, -signal.SIGILL, -signal.SIGFPE, 101, 134, 139)

Ended = collections.namedtuple("Ended", "status out err seconds cpu peak_mb timed_out")


def broke_down(ended):
    """A panic, an abort or a crash, in whatever way it shows."""
    text = ended.err + ended.out
    return ended.status in ABORTS or b"panicked at" in text or b"memory allocation of" in text or b"Traceback" in text \
        or b"VP1008" in text


def first_line(data, limit=160):
    text = data.decode("utf-8", "replace").strip().split("\n")[0]
    return "".join(c if c.isprintable() else "\\x%02x" % ord(c) for c in text)[:limit]


class Judge:
    """Counts what was asked and what went wrong, and keeps a folder for each failure."""

    def __init__(self, vpost, count, seed, keep, work):
        self.vpost = os.path.abspath(vpost)
        self.count = count
        self.seed = seed
        self.keep = keep
        self.work = work
        self.asked = collections.OrderedDict()
        self.wrong = collections.OrderedDict()
        self.notes = []
        self.silent = False
        self.tmp = os.path.join(work, "tmp")
        os.makedirs(self.tmp, exist_ok=True)
        self.rng = random.Random(seed)

    def check(self, name):
        self.asked.setdefault(name, 0)
        self.wrong.setdefault(name, [])

    def right(self, name):
        self.check(name)
        self.asked[name] += 1

    def note(self, text):
        if text not in self.notes:
            self.notes.append(text)

    def fail(self, name, case, found, expected, command=None, files=()):
        """One wrong answer. `files` are paths, or pairs of a name and its bytes."""
        self.check(name)
        self.asked[name] += 1
        number = sum(len(w) for w in self.wrong.values())
        self.wrong[name].append("%s: %s" % (case, found))
        folder = os.path.join(self.keep, "%03d-%s" % (number, name.replace("/", "-").replace(" ", "-")))
        os.makedirs(folder, exist_ok=True)
        text = "check: %s\ncase: %s\nfound: %s\nexpected: %s\n" % (name, case, found, expected)
        if command is not None:
            text += "command: %s\n" % (command if isinstance(command, str) else words(command))
        with open(os.path.join(folder, "what.txt"), "w", errors="backslashreplace") as out:
            out.write(text)
        for item in files:
            try:
                if isinstance(item, tuple):
                    with open(os.path.join(folder, item[0]), "wb") as out:
                        out.write(item[1][:4_000_000])
                elif os.path.isfile(item) and os.path.getsize(item) < 4_000_000:
                    shutil.copy(item, os.path.join(folder, os.path.basename(item)))
            except OSError:
                pass
        if not self.silent:
            print("  WRONG %s | %s | found: %s" % (name, case, found), flush=True)

    def judge(self, name, wrong, case, found, expected, command=None, files=()):
        """Counts one question; `wrong` says whether the answer was."""
        if wrong:
            self.fail(name, case, found, expected, command, files)
        else:
            self.right(name)
        return not wrong

    def folder(self, name):
        """A new empty folder."""
        path = tempfile.mkdtemp(prefix=name + "-", dir=self.work)
        return path

    def environment(self, **more):
        env = {"PATH": os.environ.get("PATH", "/usr/bin:/bin"), "HOME": self.work, "TMPDIR": self.tmp, "LANG": "C.UTF-8",
               "TERM": "xterm"}
        env.update({k: str(v) for k, v in more.items()})
        return env

    def start(self, args, cwd=None, stdin=None, stdout=None, stderr=None, env=None, umask=None, before=None, under=()):
        """Starts the command; address space is limited so that a mistake of it does not take the machine down."""
        def prepare():
            resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            for number in (signal.SIGPIPE, signal.SIGINT, signal.SIGTERM):      # a shell's background leaves SIGINT ignored
                signal.signal(number, signal.SIG_DFL)
            if umask is not None:
                os.umask(umask)
            if before is not None:
                before()
        return subprocess.Popen(list(under) + [self.vpost] + list(args), cwd=cwd or self.work, stdin=stdin or subprocess.DEVNULL,
                                stdout=stdout if stdout is not None else subprocess.DEVNULL,
                                stderr=stderr if stderr is not None else subprocess.DEVNULL,
                                env=env or self.environment(), preexec_fn=prepare)

    def run(self, args, cwd=None, data=None, timeout=60, env=None, umask=None, stdout=None, before=None, stdin=None):
        """Runs the command to its end, or to `timeout`; tells its status, words, times and peak memory."""
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err, tempfile.TemporaryFile() as given:
            if data is not None:
                given.write(data)
                given.seek(0)
                stdin = given
            begin = time.monotonic()
            child = self.start(args, cwd, stdin, stdout if stdout is not None else out, err, env, umask, before)
            late = []

            def kill():
                late.append(True)
                child.kill()
            timer = threading.Timer(timeout, kill)
            timer.start()
            _, raw, usage = os.wait4(child.pid, 0)
            timer.cancel()
            seconds = time.monotonic() - begin
            child.returncode = os.waitstatus_to_exitcode(raw)
            out.seek(0)
            err.seek(0)
            return Ended(child.returncode, out.read(), err.read(), seconds, usage.ru_utime + usage.ru_stime,
                         usage.ru_maxrss / 1024, bool(late))


def words(args):
    return " ".join(shlex.quote(str(a)) for a in args)


def program(rng, blocks, mark=""):
    """A milling program in Fanuc's words; `mark` of a fixed width tells versions of one program apart in every block."""
    lines = ["%", "O0001", "G17 G21 G40 G49 G80 G90 G54", "G0 X0. Y0.", "G43 H1 Z50.", "G1 Z40. F500"]
    x, y, z = 50.0, 50.0, 10.0
    for number in range(blocks):
        x = min(200.0, max(0.0, x + rng.uniform(-3, 3)))
        y = min(150.0, max(0.0, y + rng.uniform(-3, 3)))
        z = min(20.0, max(1.0, z + rng.uniform(-1, 1)))
        lines.append("N%06d G1 X%08.3f Y%08.3f Z%07.3f%s" % (number, x, y, z, mark))
    lines += ["G0 Z50.", "M30", "%", ""]
    return "\n".join(lines).encode()


PROFILE = """format  = 1
name    = "Judge's mill"
control = "fanuc"
chain   = "[w X Y b Z t]"
calibrated = { date = "2026-05-15", temperature_c = 20.0, instrument = "made up", repeatability_um = 0.5, uncertainty_um = 3.0 }

[axis.X]
travel_mm     = [0, 400]
resolution_mm = 0.001
errors        = "x.csv"
measured_at_mm = { Y = 10.0, Z = 5.0, tool = [0.5, 0.25, -1.0] }
[axis.Y]
travel_mm     = [0, 280]
resolution_mm = 0.001
errors        = "y.csv"
[axis.Z]
travel_mm     = [0, 300]
resolution_mm = 0.001
errors        = "z.csv"

[squareness]
EC0Y_urad = %s
EB0Z_urad = -80.0
EA0Z_urad = 55.0

[tool]
default_mm = [0.0, 0.0, 0.0]
lengths_mm = { H1 = 120.0, H2 = [0.0, 0.0, 95.5] }

[work_offsets_mm]
G54 = [40.0, 30.0, 20.0]

[correction]
tolerance_um = 1.0
minimum_segment_mm = 0.0
"""


def table(axis, last, step=20):
    """An error table of one linear axis, gently curved."""
    names = ["EX%s_um", "EY%s_um", "EZ%s_um", "EA%s_urad", "EB%s_urad", "EC%s_urad"]
    rows = ["position_mm," + ",".join(n % axis for n in names)]
    for p in range(0, last + 1, step):
        u = p / last
        rows.append("%d,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f" % (p, 30 * u, 8 * u * (1 - u), -6 * u * (1 - u), 5 * u, -4 * u, 3 * u * u))
    return "\n".join(rows) + "\n"


def profile(folder, name="mill.toml", squareness="120.0", text=None):
    """Writes a profile with its tables into `folder`; returns its path."""
    for axis, last in (("X", 400), ("Y", 280), ("Z", 300)):
        path = os.path.join(folder, axis.lower() + ".csv")
        if not os.path.exists(path):
            with open(path, "w") as out:
                out.write(table(axis, last))
    path = os.path.join(folder, name)
    with open(path, "w") as out:
        out.write(text if text is not None else PROFILE % squareness)
    return path


def write(path, data):
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    with open(path, "wb") as out:
        out.write(data if isinstance(data, bytes) else data.encode())
    return path


def read(path):
    """The bytes of a file, or None where there is none."""
    try:
        with open(path, "rb") as src:
            return src.read()
    except (FileNotFoundError, NotADirectoryError):
        return None


def tree(folder):
    """Every file below a folder: its path there, and its bytes; links as what they say."""
    found = {}
    for root, dirs, files in os.walk(folder):
        for name in files + [d for d in dirs if os.path.islink(os.path.join(root, d))]:
            path = os.path.join(root, name)
            key = os.path.relpath(path, folder)
            if os.path.islink(path):
                found[key] = b"-> " + os.fsencode(os.readlink(path))
            elif os.path.isfile(path):
                found[key] = read(path)
            else:
                found[key] = b"special"
    return found


def stop(child, timeout=5.0):
    """SIGSTOP, and waits until every thread stands still. False where the process had ended."""
    try:
        os.kill(child.pid, signal.SIGSTOP)
    except ProcessLookupError:
        return False
    end = time.monotonic() + timeout
    while time.monotonic() < end:
        if child.poll() is not None:
            return False
        try:
            states = []
            for task in os.listdir("/proc/%d/task" % child.pid):
                with open("/proc/%d/task/%s/stat" % (child.pid, task)) as src:
                    states.append(src.read().rsplit(")", 1)[1].split()[0])
        except (FileNotFoundError, ProcessLookupError):
            continue
        if all(s in "TtZX" for s in states):
            return child.poll() is None
        time.sleep(0.001)
    return True
