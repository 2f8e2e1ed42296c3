"""Parts for tools/torture, tools/sigmas and tools/spoilt: simulated once, reconstructed up to the
adjustment, compared with the truth where something could be seen, and judged."""
import dataclasses
import json
import shutil
import subprocess


@dataclasses.dataclass
class Part:
    name: str
    simulate: list  # arguments of rigmap-simulate
    faults: list  # NAME=VALUE, as --fault and --rig-error take them
    rig_errors: list

    def request(self):
        return (self.simulate + repeat('--fault', self.faults) +
                repeat('--rig-error', self.rig_errors))

    def drawn(self):
        return ' '.join(self.simulate + self.faults + self.rig_errors)


class Failure(Exception):
    """A program that ended with an error, or not by itself."""

    def __init__(self, program, run):
        super().__init__(f'{program}: {(run.stderr.strip().splitlines() or [""])[-1]}')
        self.exit_code = run.returncode

    def is_crash(self):
        return self.exit_code not in (1, 2)


def repeat(option, values):
    return [word for value in values for word in (option, value)]


def simulate(part, folder, build):
    """Writes folder/data and folder/truth, without the true surface, unless an equal request has."""
    note = folder.with_suffix('.request')
    if folder.exists() and note.exists() and note.read_text() == ' '.join(part.request()):
        return  # an earlier run made it
    note.unlink(missing_ok=True)
    folder.parent.mkdir(parents=True, exist_ok=True)
    run_simulator(build, part.request() + ['--out', folder, '--threads', '1', '--depth-every', '1000',
                                           '--no-surface'])
    note.write_text(' '.join(part.request()))


def known_result(path, asked):
    """What an earlier run found, if it was asked the same; else nothing."""
    if not path.exists():
        return None
    known = json.loads(path.read_text())
    return known.get('found') if known.get('asked') == asked else None


def keep_result(path, asked, found):
    path.write_text(json.dumps({'asked': asked, 'found': found}))


def write_rig(part, folder, build):
    """The rig file that the part's errors make of the rig as it is."""
    run_simulator(build, part.request() + ['--rig-only', '--out', folder])
    return folder / 'data' / 'rig.yaml'


def run_simulator(build, arguments):
    run = subprocess.run([build / 'rigmap-simulate', *arguments, '--quiet', '--force'],
                         capture_output=True, text=True)
    if run.returncode != 0:
        raise Failure('simulator', run)


# Where a technique has its poses.
LAST_STAGE = {'rig': 'adjustment', 'wheels': 'dead_reckoning', 'filter': 'filter'}


def reconstruct(dataset, result, build, options, parts=1, rig=None, technique='rig'):
    """Up to the poses, anew, in so many parts, with that rig file or the data set's. The exit code,
    0 or 3, and the last line of what was said."""
    shutil.rmtree(result, ignore_errors=True)
    command = ['part'] if parts == 1 else ['run', '--split', str(parts)]
    if rig:
        command += ['--rig', rig]
    if technique != 'rig':
        command += ['--technique', technique]
    run = subprocess.run([build / 'rigmap', *command, '--dataset', dataset, '--out', result,
                          '--until', LAST_STAGE.get(technique, 'trajectory'), '--threads', '1',
                          '--quiet',
                          *repeat('--set', options)], capture_output=True, text=True)
    if run.returncode not in (0, 3):
        raise Failure('rigmap', run)
    return run.returncode, (run.stderr.strip().splitlines() or [''])[-1]


ACCURACY_PCT = 1.0  # rigmap's default
MAX_STATED = 2.0  # times the stated 95 %


def is_right(scale_pct, ate_pct, scale_95_pct, position_95_pct):
    """Whether errors are within the accuracy asked for and twice what was stated. What is not a
    number is not: no comparison holds."""
    return (abs(scale_pct) <= ACCURACY_PCT and abs(scale_pct) <= MAX_STATED * scale_95_pct and
            ate_pct <= ACCURACY_PCT and ate_pct <= MAX_STATED * position_95_pct)


def truth_of(folder):
    return next((folder / 'truth').glob('Part*'))


def usable_truth(truth, folder):
    """The true trajectory without frames of which an image is black or damaged: nothing can be
    measured in those, and their sigmas say so."""
    unusable = set(json.loads((truth / 'truth.json').read_text())['unusable_frames'])
    stamps = {float(row.split()[2]) for row in (truth / 'frames.txt').read_text().splitlines()
              if not row.startswith('#') and int(row.split()[0]) in unusable}
    rows = [row for row in (truth / 'trajectory.tum').read_text().splitlines(keepends=True)
            if row.startswith('#') or float(row.split()[0]) not in stamps]
    path = folder / 'usable.tum'
    path.write_text(''.join(rows))
    return path


def evaluate(result, truth, build):
    """What rigmap evaluate says of a result against a true trajectory."""
    run = subprocess.run([build / 'rigmap', 'evaluate', result, '--truth', truth, '--json'],
                         capture_output=True, text=True)
    if run.returncode != 0:
        raise Failure('rigmap evaluate', run)
    return json.loads(run.stdout)
