# How long the rest of a run takes, from what its steps took: plain Python, tested as such.
from statistics import fmean, median

TYPICAL = {"verify": 120, "figures": 6, "analysis": 4, "resolution": 4, "runs": 3, "index": 3}
"""Seconds of steps of which no benchmark is kept, 2 of others; their ratios matter alone."""
ENOUGH = 4  # finished steps without benchmarks from which on the machine's speed is known
HEAD_START = 10  # seconds for which steps are taken to follow one another


class Pace:
    """Steps of a workflow: those to do, under way and done.

    counts: steps to do by rule. recorded: seconds by rule and study, of an earlier run.
    """

    def __init__(self, counts, recorded, begun):
        self.counts, self.recorded, self.begun = dict(counts), dict(recorded), begun
        self.running, self.ratios, self.busy = {}, [], 0.0
        self.is_new = 2 * len(self.recorded) < sum(self.counts.values())

    def expected(self, rule):
        """Return the mean seconds of the steps of a rule that are still to do."""
        seconds = [value for (name, _), value in self.recorded.items() if name == rule]
        return fmean(seconds) if seconds else TYPICAL.get(rule, 2)

    def start(self, job, rule, study, now):
        """Count a step as under way."""
        mean = self.expected(rule)
        self.counts[rule] = self.counts.get(rule, 1) - 1
        self.running[job] = now, self.recorded.pop((rule, study), mean)

    def finish(self, job, now):
        """Count a step as done."""
        if job in self.running:
            start, seconds = self.running.pop(job)
            self.busy += now - start
            self.ratios.append((now - start) / seconds)

    def left(self, now):
        """Return the seconds left, None as long as nothing is known of this machine."""
        if self.is_new and len(self.ratios) < ENOUGH:
            return None
        speed = median(self.ratios) if self.ratios else 1.0
        seconds = sum(count * self.expected(rule) for rule, count in self.counts.items())
        rest = speed * seconds + sum(
            max(0.0, speed * seconds - (now - start)) for start, seconds in self.running.values()
        )
        busy = self.busy + sum(now - start for start, _ in self.running.values())
        return rest * (now - self.begun + HEAD_START) / (busy + HEAD_START)


def duration(seconds):
    """Return a duration in words: seconds by tens, from 90 s on minutes."""
    return f"{seconds / 60:.0f} min" if seconds >= 90 else f"{10 * max(1, round(seconds / 10))} s"
