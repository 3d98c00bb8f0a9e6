# How long the rest of a run takes, from what its steps took: plain Python, tested as such.
from statistics import fmean, median

TYPICAL = {"verify": 27, "report": 11, "report_checks": 12, "runs": 4, "index": 5, "comparison": 5}
"""Seconds of steps of which no benchmark is kept, 2 of others; their ratios matter alone."""
ALONE = {"runs", "resolution", "refinement"}
"""Rules whose steps take all cores; others run side by side."""
ENOUGH = 2  # finished steps without benchmarks from which on the machine's speed is known


class Pace:
    """Steps of a workflow: those to do, under way and done.

    counts: steps to do by rule.
    recorded: seconds by rule and study, of an earlier run.
    cores: on which steps run side by side.
    """

    def __init__(self, counts, recorded, cores):
        self.counts, self.recorded, self.cores = dict(counts), dict(recorded), cores
        self.running, self.ratios = {}, []
        self.is_new = 2 * len(self.recorded) < sum(self.counts.values())

    def expected(self, rule):
        """Return the mean seconds of the steps of a rule that are still to do."""
        seconds = [value for (name, _), value in self.recorded.items() if name == rule]
        return fmean(seconds) if seconds else TYPICAL.get(rule, 2)

    def start(self, job, rule, study, now):
        """Count a step as under way."""
        mean = self.expected(rule)
        self.counts[rule] = self.counts.get(rule, 1) - 1
        self.running[job] = rule, now, self.recorded.pop((rule, study), mean)

    def finish(self, job, now):
        """Count a step as done."""
        if job in self.running:
            _, start, seconds = self.running.pop(job)
            self.ratios.append((now - start) / seconds)

    def left(self, now):
        """Return the seconds left, None as long as nothing is known of this machine."""
        if self.is_new and len(self.ratios) < ENOUGH:
            return None
        speed = median(self.ratios) if self.ratios else 1.0
        rest = [(rule, speed * count * self.expected(rule)) for rule, count in self.counts.items()]
        rest += [
            (rule, max(0.0, speed * seconds - (now - start)))
            for rule, start, seconds in self.running.values()
        ]
        return sum(seconds / (1 if rule in ALONE else self.cores) for rule, seconds in rest)


def duration(seconds):
    """Return a duration in words: seconds by tens, from 90 s on minutes."""
    return f"{seconds / 60:.0f} min" if seconds >= 90 else f"{10 * max(1, round(seconds / 10))} s"
