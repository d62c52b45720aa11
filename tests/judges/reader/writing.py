"""What writers of random programs do alike, whatever the dialect. `snippet(kinds)` is each writer's own."""


class Writing:
    def p(self, chance):
        return self.rng.random() < chance

    def abs(self):
        if not self.absolute:
            self.absolute = True
            self.say("G90")

    def body_of(self, *kinds):
        """Lines of a subprogram or loop, written apart; behind it words are absolute, or not, as before."""
        was, self.lines = self.lines, []
        start = self.absolute
        self.depth += 1
        for _ in range(self.rng.randint(1, 2)):
            self.snippet({k: 1 for k in kinds})
        self.depth -= 1
        if self.absolute != start:
            self.absolute = start
            self.lines.append("G90" if start else "G91")
        body, self.lines = self.lines, was
        return body
