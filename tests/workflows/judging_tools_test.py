#!/usr/bin/python3
"""What tools/torture and tools/sigmas call right, and how they count.

usage: judging_tools_test.py TOOLS
"""
import importlib.machinery
import math
import pathlib
import sys
import tempfile
import types
import unittest
import unittest.mock

import numpy as np
from scipy.spatial.transform import Rotation

TOOLS = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else 'tools').resolve()
sys.path.insert(0, str(TOOLS))
sys.dont_write_bytecode = True
import simulated_part  # noqa: E402


def load(name):
    loader = importlib.machinery.SourceFileLoader(name, str(TOOLS / name))
    module = types.ModuleType(name)
    loader.exec_module(module)
    return module


sigmas, torture = load('sigmas'), load('torture')
COLUMNS = ('stamp_ns,tx,ty,tz,qx,qy,qz,qw,sx,sy,sz,srx,sry,srz,source')


class WrongInSilence(unittest.TestCase):
    def test_within_what_was_asked_and_stated_is_right(self):
        self.assertTrue(simulated_part.is_right(0.5, 0.1, 0.4, 0.2))
        self.assertTrue(simulated_part.is_right(-0.5, 0.1, 0.4, 0.2))

    def test_beyond_twice_what_was_stated_is_wrong(self):
        self.assertFalse(simulated_part.is_right(-0.5, 0.1, 0.24, 0.2))
        self.assertFalse(simulated_part.is_right(0.5, 0.3, 0.4, 0.14))

    def test_beyond_what_was_asked_is_wrong_whatever_was_stated(self):
        self.assertFalse(simulated_part.is_right(1.1, 0.1, 5.0, 5.0))
        self.assertFalse(simulated_part.is_right(0.1, 1.1, 5.0, 5.0))

    def test_what_is_not_a_number_is_wrong(self):
        for bad in range(4):
            numbers = [0.1, 0.1, 0.4, 0.2]
            numbers[bad] = math.nan
            self.assertFalse(simulated_part.is_right(*numbers), bad)


class Sigmas(unittest.TestCase):
    def drives(self, factor, bias=0.0, count=40, poses=20):
        """Errors in sigmas, of each drive its own."""
        random = np.random.default_rng(1)
        return [{'exit': 3 if i == 0 else 0,
                 'poses': (factor * random.standard_normal((poses, 4)) +
                           [0, 0, bias, 0]).tolist(),
                 'scale': factor * random.standard_normal(), 'rig': bias}
                for i in range(count)]

    def test_errors_as_large_as_their_sigmas_are_good(self):
        kind = sigmas.Kind('s-curve', self.drives(1.0))
        self.assertTrue(kind.is_good(), kind.row())
        self.assertEqual((kind.drives, kind.untrusted), (40, 1))
        self.assertAlmostEqual(kind.anees, 1.0, delta=0.1)
        self.assertAlmostEqual(kind.covered[0], 68, delta=4)
        self.assertAlmostEqual(kind.covered[1], 95, delta=2)
        self.assertGreater(kind.within_three, 97)

    def test_sigmas_too_small_or_too_large_are_not(self):
        self.assertFalse(sigmas.Kind('s-curve', self.drives(1.5)).is_good())
        self.assertFalse(sigmas.Kind('s-curve', self.drives(0.5)).is_good())
        # An exact rig that nobody calls exact may be better than it says.
        self.assertTrue(sigmas.Kind('exact-rig', self.drives(0.5)).is_good())
        self.assertFalse(sigmas.Kind('exact-rig', self.drives(1.5)).is_good())

    def test_an_error_in_common_shows_on_its_axis(self):
        kind = sigmas.Kind('loop', self.drives(1.0, bias=2.0))
        self.assertFalse(kind.is_good())
        self.assertAlmostEqual(kind.axes[2], 5.0, delta=0.5)
        self.assertAlmostEqual(kind.axes[0], 1.0, delta=0.2)
        self.assertAlmostEqual(kind.rig[0], 4.0)

    def test_poses_are_laid_on_the_truth_by_their_datum_alone(self):
        """A world turned and moved; one pose 3 mm off in x where its sigma is 1 mm."""
        turn, shift = Rotation.from_euler('z', 40, degrees=True), np.array([3.0, -2.0, 0.5])
        with tempfile.TemporaryDirectory() as folder:
            rows, truth = [COLUMNS], {}
            for i in range(4):
                true = Rotation.from_euler('xz', [5, 20 * i], degrees=True), np.array([i, 0.1 * i, 0])
                truth[1000 * i] = true
                x = turn.apply(true[1]) + shift + [0.003 if i == 2 else 0, 0, 0]
                numbers = [*x, *(turn * true[0]).as_quat(), *([0.0 if i == 0 else 1e-3] * 6)]
                rows.append(','.join([str(10 ** 9 * i), *map(repr, map(float, numbers)), 'adjusted']))
            path = pathlib.Path(folder)
            (path / 'trajectory.csv').write_text('\n'.join(rows) + '\n')
            errors = np.array(sigmas.normalised_errors(path, truth))
        self.assertEqual(errors.shape, (3, 4))
        expected = np.zeros((3, 4))
        expected[1, 0] = 3.0
        np.testing.assert_allclose(errors, expected, atol=1e-6)


    def prism_errors(self, folder, bend_m=0.0):
        """Of a rover that drives a bend, a prism 0.3 m behind and 0.8 m above its camera."""
        lever, turn, rows, track = np.array([0.0, -0.8, -0.3]), 0.7, [COLUMNS], []
        for i in range(40):
            heading = 0.04 * i
            body = Rotation.from_euler('zx', [heading, -90], degrees=False)
            x = np.array([2 * np.sin(heading), 2 - 2 * np.cos(heading), 0.1])
            prism = Rotation.from_euler('z', turn).apply(body.apply(lever) + x) + [5, 6, 7]
            track.append([i + 0.25, *prism[:2]])
            x = x + [0.0, bend_m * (i / 39) ** 2, 0.0]
            numbers = [*x, *body.as_quat(), *([0.0 if i == 0 else 1e-3] * 6)]
            rows.append(','.join([str(10 ** 9 * i), *map(repr, map(float, numbers)), 'adjusted']))
        path = pathlib.Path(folder)
        (path / 'trajectory.csv').write_text('\n'.join(rows) + '\n')
        fit = {'lever': lever.tolist(), 'dt_s': 0.25}
        return sigmas.normalised_prism_errors(path, np.array(track), fit, 1e-3)

    def test_a_prism_judges_horizontal_positions_by_its_sigma_and_theirs(self):
        with tempfile.TemporaryDirectory() as folder:
            exact, bent = self.prism_errors(folder), self.prism_errors(folder, 0.05)
        self.assertEqual(exact.shape, (39, 2))
        np.testing.assert_allclose(exact, 0, atol=1e-6)
        # Its turn takes up some of it; the end is off by no more than 50 mm in sigmas of 1.7 mm.
        self.assertGreater(np.abs(bent).max(), 5)
        self.assertLess(np.abs(bent).max(), 50 / 1.7)

    def test_a_file_of_three_columns_is_the_track_of_a_prism(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / 'truth.txt'
            path.write_text('# t x y\n\n1.5 2 3\n')
            self.assertTrue(sigmas.is_prism(path))
            path.write_text('# t x y\n1.5 2 3 0 0 0 1 0\n')
            self.assertFalse(sigmas.is_prism(path))
            self.assertFalse(sigmas.is_prism(pathlib.Path(folder)))


class Resuming(unittest.TestCase):
    """What has been judged is not judged again, unless something else is asked."""

    def judge(self, out, options=(), resume=True, faults=()):
        part = simulated_part.Part('part-1-0000', ['--pairs', '12'], list(faults), [])
        verdict = torture.Verdict(part, 'ok', 0, 0.1, -0.2, 0.3, math.nan, 'because')
        called = []
        args = types.SimpleNamespace(out=pathlib.Path(out), set=list(options), resume=resume)
        with unittest.mock.patch.object(torture, 'judge',
                                        lambda *_: called.append(1) or verdict):
            found = torture.judge_once(part, part, args)
        self.assertEqual(found.line(), verdict.line())
        return len(called)

    def test_torture_takes_up_where_it_ended(self):
        with tempfile.TemporaryDirectory() as out:
            self.assertEqual(self.judge(out), 1)
            self.assertEqual(self.judge(out), 0)
            self.assertEqual(self.judge(out, resume=False), 1)

    def test_torture_judges_again_what_is_asked_otherwise(self):
        with tempfile.TemporaryDirectory() as out:
            self.judge(out)
            self.assertEqual(self.judge(out, options=['adjustment.rounds=2']), 1)
            self.assertEqual(self.judge(out, faults=['black=1']), 1)
            self.assertEqual(self.judge(out, faults=['black=1']), 0)


if __name__ == '__main__':
    unittest.main()
