"""Flow of RS274/NGC: parameters and O-words (LinuxCNC's G-code reference, O codes), M98 and M99 of Mach3."""

import re

import expr
from core import Invalid
from iso import Block

WORD = re.compile(r"O\s*(\d+|<[^>]+>)\s*(SUB|ENDSUB|CALL|RETURN|WHILE|ENDWHILE|DO|REPEAT|ENDREPEAT|IF|ELSEIF|ELSE|ENDIF"
                  r"|BREAK|CONTINUE)\b(.*)$")


class Return(Exception):
    pass


class NgcFlow:
    """Mixed into an interpreter of blocks."""

    steps = 40000

    def look(self, name):
        if isinstance(name, str):
            table = self.variables if name.startswith("_") else self.locals[-1]
            if name not in table:
                raise Invalid(f"#<{name}> without a value")
            return table[name]
        table = self.locals[-1] if 1 <= name <= 30 else self.variables
        return table.get(name, 0.0)

    def assign(self, name, value):
        if isinstance(name, str):
            (self.variables if name.startswith("_") else self.locals[-1])[name] = value
        else:
            (self.locals[-1] if 1 <= name <= 30 else self.variables)[name] = value

    def evaluate(self, text):
        return expr.Expr(text, self.look, "ngc").whole()

    def run(self, text):
        self.lines = [self.strip(line) for line in text.split("\n")]
        self.subs, self.programs = {}, {}
        for i, line in enumerate(self.lines):
            match = WORD.match(line)
            if match and match.group(2) == "SUB":
                self.subs[match.group(1)] = i
            match = re.match(r"O(\d+)\s*$", line)
            if match:
                self.programs[int(match.group(1))] = i
        self.locals = [{}]
        self.over = False
        self.span(0, len(self.lines))
        return self.events

    def end_of(self, i, name, ends, stop):
        """The line of the word that ends a block opened at line i."""
        for j in range(i + 1, stop):
            match = WORD.match(self.lines[j])
            if match and match.group(1) == name and match.group(2) in ends:
                return j
        raise Invalid(f"{name} without {ends}")

    def span(self, start, stop):
        """Runs lines from start to before stop."""
        i = start
        while i < stop and not self.over:
            self.steps -= 1
            if self.steps < 0:
                raise Invalid("too many steps")
            text, self.line = self.lines[i], i + 1
            text = re.sub(r"^/?\s*N\d+\s*", "", text)
            match = WORD.match(text)
            if match:
                i = self.word(match, i, stop)
                continue
            if text and not text.startswith("%"):
                if self.plain(text):
                    return "sub"
            i += 1
        return None

    def word(self, match, i, stop):
        name, what, rest = match.groups()
        rest = rest.strip()
        if what == "SUB":
            return self.end_of(i, name, ("ENDSUB",), len(self.lines)) + 1
        if what == "CALL":
            self.sub(name, [float(self.evaluate(p)) for p in self.brackets(rest)])
            return i + 1
        if what == "RETURN":
            raise Return
        if what == "REPEAT":
            end = self.end_of(i, name, ("ENDREPEAT",), stop)
            for _ in range(int(self.evaluate(rest))):
                self.span(i + 1, end)
            return end + 1
        if what == "WHILE":
            end = self.end_of(i, name, ("ENDWHILE",), stop)
            while self.evaluate(rest) and not self.over:
                self.span(i + 1, end)
            return end + 1
        if what == "DO":
            end = self.end_of(i, name, ("WHILE",), stop)
            condition = WORD.match(self.lines[end]).group(3)
            while not self.over:
                self.span(i + 1, end)
                if not self.evaluate(condition):
                    break
            return end + 1
        if what == "IF":
            end = self.end_of(i, name, ("ENDIF",), stop)
            at, done = i, False
            while at != end:
                head = WORD.match(self.lines[at])
                after = self.end_of(at, name, ("ELSEIF", "ELSE", "ENDIF"), stop)
                if not done and (head.group(2) == "ELSE" or self.evaluate(head.group(3))):
                    done = True
                    self.span(at + 1, after)
                at = after
            return end + 1
        raise Invalid(f"O word {what}")

    @staticmethod
    def brackets(text):
        found, depth, begin = [], 0, 0
        for i, c in enumerate(text):
            if c == "[":
                if depth == 0:
                    begin = i
                depth += 1
            elif c == "]":
                depth -= 1
                if depth == 0:
                    found.append(text[begin:i + 1])
        return found

    def sub(self, name, arguments):
        if name not in self.subs:
            raise Invalid(f"no sub {name}")
        start = self.subs[name]
        end = self.end_of(start, name, ("ENDSUB",), len(self.lines))
        self.locals.append({k + 1: v for k, v in enumerate(arguments)})
        try:
            self.span(start + 1, end)
        except Return:
            pass
        self.locals.pop()

    def plain(self, text):
        """Assignments act behind the words of their block."""
        assignments, rest = [], text
        while True:
            match = re.search(r"#\s*(<[^>]+>|\d+|\[[^\]]*\])\s*=", rest)
            if not match:
                break
            _, at, _ = expr.value_at(rest, match.end(), self.look, "ngc")
            left = match.group(1)
            key = left[1:-1].lower() if left.startswith("<") else int(round(self.evaluate(left)))
            assignments.append((key, expr.value_at(rest, match.end(), self.look, "ngc")[0]))
            rest = rest[:match.start()] + " " + rest[at:]
        if re.match(r"O\d+\s*$", rest.strip()):
            return False
        block = self.read(rest) if rest.strip() else Block()
        for key, value in assignments:
            self.assign(key, value)
        if 98 in block.m:
            number, count = int(block.words.pop("P")), int(block.words.pop("L", 1))
            if number not in self.programs:
                raise Invalid(f"no O{number}")
            block.m.remove(98)
            self.execute(block)
            for _ in range(count):
                self.span(self.programs[number] + 1, len(self.lines))
            return False
        if 99 in block.m:
            block.m.remove(99)
            self.execute(block)
            return True
        self.execute(block)
        if 2 in block.m or 30 in block.m:
            self.over = True
        return False


class PlainFlow:
    """Of controls whose programs are plain blocks."""

    def run(self, text):
        self.locals = [{}]
        for i, line in enumerate(text.split("\n")):
            self.line = i + 1
            line = self.strip(line)
            if line.startswith("%") or not line:
                continue
            line = re.sub(r"^[O:]\d+", "", line)
            block = self.read(line)
            self.execute(block)
            if 2 in block.m or 30 in block.m:
                break
        return self.events
