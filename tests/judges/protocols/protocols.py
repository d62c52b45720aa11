"""Measurement protocols as shops use them, and the machines that they meet.

A protocol is `build(machine, places, targets)`: rows, where `places` draws where lines and circles lie and `targets`
draws the positions on them. The same two draws again are the same protocol repeated.
"""

from machine import Row
from measure import Measure


class Case:
    """A machine with hidden parts (each with the SNR it is to have), the protocol, and how the shop writes it down."""

    def __init__(self, kind, hidden, truth, build, noise, reading="vector", **how):
        self.kind, self.hidden, self.truth, self.build = kind, hidden, truth, build
        self.noise, self.reading, self.how = noise, reading, how
        self.slip = how.get("flip", "")

    def measure(self, places, targets):
        return Measure(self.build(self.hidden, places, targets), self.noise, self.reading, **self.how)


def targets_of(machine, random, axis, count, uneven=True, low=0.03, high=0.97):
    """Targets of ISO 230-2, 5.3: evenly over the axis, each shifted by up to a third of the step."""
    step = (high - low) / (count - 1)
    shares = [low + step * (i + (random.uniform(-.33, .33) if uneven else 0)) for i in range(count)]
    return [round(machine.at(axis, min(high, max(low, share))), 3) for share in shares]


def passes(run, axis, at, targets, count, comps, both=True, one_run=True, tool=None):
    """A line along an axis, `count` times; both ways where `both`, each pass a run of its own or all one."""
    rows = []
    for number in range(count):
        name = run if one_run else f"{run}{number}"
        for side in (1, -1) if both else (1,):
            for target in targets[::side]:
                q, dirs = list(at), [0, 0, 0]
                q[axis], dirs[axis] = target, side
                rows.append(Row(name, q, dirs, comps=comps, tool=tool))
    return rows


def somewhere(machine, random, low=0.1, high=0.9):
    return [round(machine.at(k, random.uniform(low, high)), 2) for k in range(3)]


def shared(random):
    """SNR of a fault that counts."""
    return random.choice((3, 4, 6, 10, 16))


def one_run(random):
    """Is the whole file one set-up, as three shops in ten write it, or each pass a run?"""
    return random.random() < .3
