"""What the settings of the Snakefile say to each of its jobs."""
import shlex

# Of the settings; they may stand in `arguments` as well, behind two dashes.
SETTINGS = ("traverse", "split", "max_frames", "overlap", "rig", "threads", "memory", "accuracy", "truth",
            "use_rtk")
# The jobs' own affair.
NOT_TAKEN = ("--dataset", "--part", "--frames", "--out", "--until", "--from", "--force")
OF_PLAN = ("--format", "--config", "--set")
OF_JOIN = ("--config", "--set", "--depth-maps")
DEFAULT_THREADS = 2


def options(words):
    """[name, values...] of each option; --name=value is the same as --name value."""
    found = []
    for word in words:
        if word.startswith("--"):
            name, equals, value = word.partition("=")
            found.append([name, value] if equals else [name])
        elif found:
            found[-1].append(word)
        else:
            raise ValueError(f"arguments: expected options, found {word!r}")
    return found


def quoted(groups):
    return " ".join(shlex.quote(word) for group in groups for word in group)


class Arguments:
    """Of the settings, as text; each line of arguments is quoted for a shell."""

    def __init__(self, settings):
        self._values = {name: str(settings.get(name, "")) for name in SETTINGS}
        self._more = []
        for name, *values in options(shlex.split(str(settings.get("arguments", "")))):
            setting = name[2:].replace("-", "_")
            if name in NOT_TAKEN:
                raise ValueError(f"arguments: expected no {name}, which the jobs give themselves")
            if setting in SETTINGS:
                self._values[setting] = self._values[setting] or (values[-1] if values else "true")
            elif name != "--quiet":  # jobs are
                self._more.append([name, *values])
        try:
            self.threads = int(self._values["threads"] or DEFAULT_THREADS)
        except ValueError:
            self.threads = 0
        if self.threads < 1:
            raise ValueError(f"threads: expected 1 or more, found {self._values['threads']}")

    def _given(self, *names):
        return [["--" + name.replace("_", "-"), self._values[name]] for name in names
                if self._values[name]]

    def _of(self, names):
        return [group for group in self._more if group[0] in names]

    @property
    def rig(self):
        """"--rig FILE", where one was given."""
        return quoted(self._given("rig"))

    @property
    def plan(self):
        """With the threads of a part, by which its time is estimated."""
        return quoted([*self._given("traverse", "split", "max_frames", "overlap", "rig", "memory"),
                       ["--threads", str(self.threads)], *self._of(OF_PLAN)])

    def part(self, planned):
        """Of the plan, then those that hold for all; neither the rig nor threads."""
        own = [group for group in options(planned) if group[0] not in ("--rig", "--threads")]
        return quoted([*own, *self._given("accuracy", "memory"), *self._more])

    @property
    def join(self):
        """The whole is mapped and judged by the same options as its parts."""
        tie = [["--use-rtk"]] if self._values["use_rtk"].lower() in ("true", "yes", "1") else []
        return quoted([*self._given("accuracy", "memory", "truth"), *self._of(OF_JOIN), *tie])
