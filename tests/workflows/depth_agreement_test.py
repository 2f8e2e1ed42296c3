#!/usr/bin/python3
"""tools/depth-agreement on a wall that two keyframes see.

usage: depth_agreement_test.py TOOLS
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from PIL import Image

TOOL = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else 'tools').resolve() / 'depth-agreement'
FOCAL, BASELINE_M, WALL_M = 800.0, 0.025, 4.0  # 5 px of disparity
SIZE = 960, 720
STAMPS = 10 ** 18, 10 ** 18 + 5 * 10 ** 8


class DepthAgreement(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def write_run(self, disparities, sigma_m=0.1):
        """Two keyframes, the second 0.4 m to the right of the first, before the wall."""
        maps = self.root / 'depth_maps'
        maps.mkdir()
        (maps / 'camera.json').write_text(json.dumps(self.camera() | {
            'width': SIZE[0], 'height': SIZE[1], 'left_from_depth': list(np.eye(3).ravel())}))
        for stamp, disparity in zip(STAMPS, disparities):
            depth = np.ones(SIZE[::-1], np.float32) * np.float32(FOCAL * BASELINE_M / disparity)
            Image.fromarray(depth).save(maps / f'{stamp}.tif')
            Image.fromarray(np.full_like(depth, sigma_m)).save(maps / f'{stamp}.sigma.tif')
        (self.root / 'trajectory.tum').write_text(
            '# stamp x y z qx qy qz qw\n1000000000.000000000 0 0 0 0 0 0 1\n'
            '1000000000.500000000 0.4 0 0 0 0 0 1\n')
        (self.root / 'summary.json').write_text(
            json.dumps({'verdict': {'known': {'baseline_m': BASELINE_M}}}))

    def camera(self):
        return {'fx': FOCAL, 'fy': FOCAL, 'cx': 480.0, 'cy': 360.0}

    def run_tool(self, *arguments):
        return subprocess.run([TOOL, self.root, *arguments], capture_output=True, text=True)

    def last_row(self, *arguments):
        ended = self.run_tool(*arguments)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return ended.stdout.splitlines()[-1].split()

    def test_maps_that_agree(self):
        self.write_run([5.0, 5.0])
        _, apart, points, within, sigma, _, bias = self.last_row('--apart', '1')
        self.assertEqual(apart, '1')
        # Of 320 by 240 pixels that are looked at the 80 px that 0.4 m are leave the image.
        self.assertAlmostEqual(int(points), (960 - 80) / 3 * 240, delta=240)
        self.assertEqual([float(v) for v in (within, sigma, bias)], [100.0, 0.0, 0.0])

    def test_the_second_has_more_disparity(self):
        self.write_run([5.0, 5.3])
        *_, systematic, bias = self.last_row('--apart', '1')
        self.assertAlmostEqual(float(bias), 0.3, places=3)
        self.assertAlmostEqual(float(systematic), 0.3, places=3)

    def test_places_of_the_image_that_differ(self):
        columns = np.where(np.arange(SIZE[0]) < SIZE[0] / 2, 4.6, 5.4)
        self.write_run([5.0, columns])
        systematic = self.last_row('--apart', '1')[-2]
        self.assertAlmostEqual(float(systematic), 0.4, places=2)

    def test_beyond_two_pixels(self):
        self.write_run([5.0, 8.0])
        self.assertEqual(float(self.last_row('--apart', '1')[3]), 0.0)

    def test_errors_over_sigmas(self):
        self.write_run([5.0, 5.3], sigma_m=0.15)  # the second is off by 0.23 m, 1.5 sigmas
        truth = self.root / 'truth'
        (truth / 'depth').mkdir(parents=True)
        (truth / 'depth' / 'camera.json').write_text(json.dumps(self.camera() | {'unit_m': 0.001}))
        wall = np.full(SIZE[::-1], round(WALL_M / 0.001), np.uint16)
        for frame in (0, 1):
            Image.fromarray(wall).save(truth / 'depth' / f'depth_{frame:04}.png')
        (truth / 'frames.txt').write_text('0 a 1000000000.0\n1 b 1000000000.5\n')
        row = self.last_row('--truth', truth)
        self.assertEqual(row[:3], ['4', 'to', '6'])
        self.assertEqual([float(v) for v in row[-3:]], [50.0, 100.0, 100.0])

    def test_nothing_to_compare(self):
        self.write_run([5.0, 5.0])
        ended = self.run_tool('--apart', '2')
        self.assertEqual(ended.returncode, 1)
        self.assertIn('2 apart', ended.stderr)

    def test_no_depth_maps(self):
        ended = self.run_tool()
        self.assertEqual(ended.returncode, 1)
        self.assertIn('camera.json', ended.stderr)


if __name__ == '__main__':
    sys.exit(0 if unittest.main(exit=False).result.wasSuccessful() else 1)
