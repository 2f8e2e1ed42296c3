#!/usr/bin/python3
"""The Snakefile and part-job, with a stand-in for rigmap that writes down what it was asked for.

usage: snakefile_test.py WORKFLOWS
"""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

WORKFLOWS = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else 'workflows').resolve()
sys.path.insert(0, str(WORKFLOWS))
sys.dont_write_bytecode = True
from job_arguments import Arguments  # noqa: E402

STAND_IN = r'''#!/usr/bin/python3
import json, os, pathlib, sys, time
here = pathlib.Path(__file__).parent
arguments = sys.argv[1:]
with open(here / 'calls', 'a') as calls:
    calls.write(json.dumps(arguments) + '\n')
def value(name):
    return arguments[arguments.index(name) + 1]
command = arguments[0]
if command == 'report':
    sys.exit(2)
if command == 'plan':
    print(json.dumps({'dataset': value('--dataset'), 'jobs': [
        {'name': name, 'threads': 1, 'memory_mb': 700, 'minutes': 5, 'pairs': 30,
         'arguments': ['--dataset', value('--dataset'), '--part', name, *frames]}
        for name, *frames in (('1',), ('2 b', '--frames', '0:40'), ('3', '--frames', '30:70'))]}))
if command == 'part':
    out = pathlib.Path(value('--out'))
    out.mkdir(parents=True, exist_ok=True)
    broken = here / ('break ' + value('--part'))
    if broken.exists():
        left = int(broken.read_text() or 1) - 1
        broken.write_text(str(left)) if left else broken.unlink()
        (out / 'half').touch()
        sys.exit('rigmap: broken')
    if (here / 'slow').exists():
        (out / 'begun').touch()
        time.sleep(60)
    (out / 'summary.json').write_text('{}')
    sys.exit(3 if value('--part') == '3' else 0)
if command == 'calibrate':
    if (here / 'untold').exists():
        sys.exit('rigmap: expected a part that tells something of its rig, found none')
    pathlib.Path(value('--rig-out')).write_text('left: {}')
if command == 'join':
    (pathlib.Path(value('--out')) / 'summary.json').write_text('{}')
    sys.exit(3)
'''


class Jobs(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        self.out = self.root / 'out'
        self.rigmap = self.root / 'rigmap'
        self.rigmap.write_text(STAND_IN)
        self.rigmap.chmod(0o755)

    def tearDown(self):
        self.folder.cleanup()

    def calls(self, command):
        file = self.root / 'calls'
        rows = [json.loads(row) for row in file.read_text().splitlines()] if file.exists() else []
        return [row for row in rows if row[0] == command and '--help' not in row]


class Snakefile(Jobs):
    def setUp(self):
        if not shutil.which('snakemake'):
            self.skipTest('snakemake is not installed')
        super().setUp()

    def snakemake(self, *arguments, settings=()):
        return subprocess.run(
            ['snakemake', '--snakefile', WORKFLOWS / 'Snakefile', '--profile',
             WORKFLOWS / 'profiles/local', '--directory', self.root, *arguments, '--config',
             f'dataset={self.root}', f'out={self.out}', f'rigmap={self.rigmap}', *settings],
            capture_output=True, text=True)

    def done(self, *arguments, **more):
        ended = self.snakemake(*arguments, **more)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return ended

    def test_dry_run_changes_nothing(self):
        ended = self.done('--dry-run')
        self.assertIn('join', ended.stdout + ended.stderr)
        self.assertFalse(self.out.exists())

    def test_parts_are_posed_calibrated_done_and_joined(self):
        self.done()
        poses = [row for row in self.calls('part') if '--until' in row]
        parts = [row for row in self.calls('part') if '--until' not in row]
        self.assertEqual(sorted(row[row.index('--part') + 1] for row in poses), ['1', '2 b', '3'])
        self.assertEqual(len(parts), 3)
        for row in parts:
            self.assertEqual(row[row.index('--rig') + 1], f'{self.out}.rig.yaml')
        joined, = self.calls('join')
        self.assertIn('--threads', joined)
        self.assertEqual(joined[1:4], [str(self.out / 'parts' / name) for name in ('1', '2 b', '3')])
        self.assertEqual(len(self.calls('calibrate')), 1)
        self.assertEqual((pathlib.Path(f'{self.out}.logs/evaluation.txt')).read_text(), 'nothing to compare with\n')
        count = len(self.calls('part'))
        self.assertIn('Nothing to be done', self.done().stderr)
        self.assertEqual(len(self.calls('part')), count)

    def test_a_part_that_failed_is_tried_again_with_more(self):
        (self.root / 'break 2 b').touch()
        said = self.done().stderr
        again = [row for row in self.calls('part') if '2 b' in row and '--until' in row]
        self.assertEqual(len(again), 2)
        self.assertIn('mem_mb=1212', said)
        self.assertIn('mem_mb=2424', said)
        self.assertIn('runtime=40', said)

    def test_the_others_are_joined_where_a_part_fails_for_good(self):
        (self.root / 'break 2 b').write_text('3')
        ended = self.snakemake()
        self.assertNotEqual(ended.returncode, 0)
        self.assertIn('NOT TRUSTED: part 2 b failed: rigmap: broken', ended.stderr)
        evaluation = pathlib.Path(f'{self.out}.logs/evaluation.txt')
        self.assertTrue(evaluation.read_text().startswith('NOT TRUSTED: part 2 b failed: rigmap: broken'))
        joined, = self.calls('join')
        self.assertEqual(joined[1:3], [str(self.out / 'parts' / name) for name in ('1', '3')])
        self.assertEqual(joined[3:5], ['--missing', 'part 2 b failed: rigmap: broken'])
        self.assertNotIn(str(self.out / 'parts/2 b'), self.calls('calibrate')[0])
        self.done()  # tries it again
        self.assertIn(str(self.out / 'parts/2 b'), self.calls('join')[-1])
        self.assertEqual(evaluation.read_text(), 'nothing to compare with\n')

    def test_a_given_rig_is_where_they_begin(self):
        for settings in (['rig=own.yaml', 'threads=1'], ['arguments=--rig own.yaml --threads 1']):
            shutil.rmtree(self.out, ignore_errors=True)
            self.done(settings=settings)
            plan = self.calls('plan')[-1]
            self.assertEqual(plan[plan.index('--rig') + 1], 'own.yaml')
            for row in self.calls('part'):
                self.assertEqual(row.count('--rig'), 1)
                self.assertEqual(row.count('--threads'), 1)
                self.assertEqual(row[row.index('--rig') + 1],
                                 'own.yaml' if '--until' in row else f'{self.out}.rig.yaml')

    # Those of one part that share frames would count twice.
    def test_calibrates_by_parts_without_shared_frames(self):
        self.rigmap.write_text(STAND_IN.replace("'--part', name, ", "'--part', '7', ").replace(
            "('1',)", "('1', '--frames', ':35')"))
        self.done()
        calibrated, = self.calls('calibrate')
        self.assertEqual(calibrated[1:-2], [str(self.out / 'parts/1')])
        self.assertEqual(len(self.calls('join')[0]), 8)

    def test_where_no_part_tells_of_the_rig_it_stays_as_given(self):
        (self.root / 'untold').touch()
        self.done()
        self.assertFalse(any('--rig' in row for row in self.calls('part')))

    def test_arguments_and_scratch_reach_every_part(self):
        scratch = self.root / 'scratch'
        scratch.mkdir()
        self.done(settings=['arguments=--accuracy 0.5', f'scratch={scratch}'])
        for row in self.calls('part'):
            self.assertEqual(row[row.index('--accuracy') + 1], '0.5')
            self.assertTrue(row[row.index('--out') + 1].startswith(str(scratch)))
        self.assertTrue((self.out / 'parts/2 b/summary.json').exists())
        self.assertEqual(list(scratch.iterdir()), [])

    def test_says_what_it_needs(self):
        ended = subprocess.run(['snakemake', '--snakefile', WORKFLOWS / 'Snakefile', '--cores', '1'],
                               capture_output=True, text=True, cwd=self.root)
        self.assertNotEqual(ended.returncode, 0)
        self.assertIn('expected --config dataset=DIR out=DIR', ended.stderr)


class JobArguments(unittest.TestCase):
    PLANNED = ['--dataset', '/d', '--rig', '/d/rig.yaml', '--frames', '0:4']

    def test_settings_and_arguments_say_the_same(self):
        for settings in ({'rig': 'a b.yaml', 'threads': 3, 'accuracy': 0.5, 'use_rtk': True, 'memory': 900,
                          'truth': 't', 'max_frames': 40, 'overlap': 5},
                         {'arguments': '--rig "a b.yaml" --threads=3 --accuracy 0.5 --use-rtk --memory 900 '
                                       '--truth t --max-frames 40 --overlap 5'}):
            given = Arguments(settings)
            self.assertEqual(given.threads, 3)
            self.assertEqual(given.rig, "--rig 'a b.yaml'")
            self.assertEqual(given.plan, "--max-frames 40 --overlap 5 --rig 'a b.yaml' --memory 900 "
                                         "--threads 3")
            self.assertEqual(given.part(self.PLANNED),
                             '--dataset /d --frames 0:4 --accuracy 0.5 --memory 900')
            self.assertEqual(given.join, '--accuracy 0.5 --memory 900 --truth t --use-rtk')

    def test_more_goes_where_it_is_taken(self):
        given = Arguments({'arguments': '--set a.b=1 c.d=2 --depth-maps --technique vo --quiet'})
        self.assertEqual(given.threads, 2)
        self.assertEqual(given.plan, '--threads 2 --set a.b=1 c.d=2')
        self.assertTrue(given.part([]).endswith('--set a.b=1 c.d=2 --depth-maps --technique vo'))
        self.assertEqual(given.join, '--set a.b=1 c.d=2 --depth-maps')

    def test_refuses_what_the_jobs_give_themselves(self):
        for arguments in ('--out x', '--frames 0:3', 'word', '--threads none'):
            with self.assertRaises(ValueError):
                Arguments({'arguments': arguments})


class PartJob(Jobs):
    def setUp(self):
        super().setUp()
        self.marker = self.root / 'marker'

    def start(self, scratch, last=False):
        return subprocess.Popen([WORKFLOWS / 'part-job', self.marker, str(int(last)), self.rigmap, self.out,
                                 scratch, '--part', '1'],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def test_leaves_why_it_failed_once_it_is_not_tried_again(self):
        for scratch in (self.root, ''):
            (self.root / 'break 1').write_text('2')
            self.assertEqual(self.start(scratch).wait(), 1)
            self.assertFalse(self.marker.exists())
            self.assertEqual(self.start(scratch, last=True).wait(), 0)
            self.assertEqual(self.marker.read_text(), 'part out failed: rigmap: broken\n')
            self.assertEqual(self.start(scratch).wait(), 0)
            self.assertEqual(self.marker.read_text(), '')
            self.marker.unlink()

    def test_brings_back_what_a_failed_part_has_done(self):
        (self.root / 'break 1').touch()
        self.assertEqual(self.start(self.root).wait(), 1)
        self.assertTrue((self.out / 'half').exists())
        self.assertEqual(self.start(self.root).wait(), 0)
        self.assertTrue((self.out / 'half').exists())
        self.assertTrue((self.out / 'summary.json').exists())

    def test_brings_back_what_is_done_when_it_is_ended(self):
        for scratch in (self.root, ''):
            shutil.rmtree(self.out, ignore_errors=True)
            (self.root / 'slow').touch()
            job = self.start(scratch)
            begun = time.time()
            while not any(self.root.glob('**/begun')) and time.time() - begun < 20:
                time.sleep(0.05)
            job.send_signal(signal.SIGTERM)
            self.assertEqual(job.wait(10), 143)
            self.assertFalse(self.marker.exists())
            self.assertTrue((self.out / 'begun').exists())
            self.assertEqual(list(self.root.glob('rigmap-*')), [])

    def test_finds_a_folder_that_was_being_replaced(self):
        old = pathlib.Path(f'{self.out}.old')
        old.mkdir()
        (old / 'kept').touch()
        self.assertEqual(self.start(self.root).wait(), 0)
        self.assertTrue((self.out / 'kept').exists())
        self.assertFalse(old.exists())


if __name__ == '__main__':
    result = unittest.main(exit=False).result
    for test, why in result.skipped:
        print(f'[  SKIPPED ] {test.id()}: {why}')
    sys.exit(0 if result.wasSuccessful() else 1)
