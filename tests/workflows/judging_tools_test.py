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


sigmas = load('sigmas')
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


if __name__ == '__main__':
    unittest.main()
