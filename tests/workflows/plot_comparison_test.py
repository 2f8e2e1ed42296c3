#!/usr/bin/python3
"""tools/plot-comparison on small comparisons.

usage: plot_comparison_test.py TOOLS
"""
import json
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest

PLOT = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else 'tools').resolve() / 'plot-comparison'


class PlotComparison(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def plotted(self, table):
        (self.root / 'comparison.csv').write_text(table)
        ended = subprocess.run([PLOT, self.root], capture_output=True, text=True)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return {path.name: path.read_text() for path in (self.root / 'plots').glob('*.svg')}

    def run_of(self, name, turn):
        """A path of 20 m, and its fixes in a world of its own that is turned a quarter."""
        way = [(0.1 * i, 0.02 * i * (i % 50) / 50) for i in range(200)]
        way = [(-y, x) for x, y in way] if turn else way
        folder = self.root / name
        folder.mkdir()
        (folder / 'trajectory.tum').write_text(
            ''.join(f'{i}.0 {x} {y} 0 0 0 0 1\n' for i, (x, y) in enumerate(way)))
        fixes = [[i * 10**9, x, y, 0.0] for i, (x, y) in enumerate(way)][::5]
        (folder / 'reference.json').write_text(json.dumps({'rtk': fixes}))

    def test_rows_that_all_failed(self):
        plots = self.plotted('part,technique,setting,repeat,run,status\n1,vo,,0,a,failed\n')
        self.assertEqual(sorted(plots), ['cost.svg', 'spread.svg'])
        self.assertIn('rigmap plot-comparison', plots['cost.svg'])

    def test_fixes_stand_for_the_true_path_and_join_the_worlds(self):
        self.run_of('a', False)
        self.run_of('b', True)
        plots = self.plotted('part,technique,setting,repeat,run,truth,status\n'
                             '1,vo,,0,a,,ok\n1,rig,,0,b,,ok\n')
        self.assertIn('1-errors.svg', plots)  # at the fixes
        routes = plots['1-routes.svg']
        self.assertIn('RTK fixes', routes)
        lines = re.findall(r'<path d="(M [^"]+)" clip-path[^>]*style="fill: none', routes)
        ends = [re.findall(r'[-\d.]+', line)[-2:] for line in lines if line.count('L') > 20]
        self.assertEqual(len(ends), 2)  # from above
        for ours, other in zip(*ends):
            self.assertAlmostEqual(float(ours), float(other), delta=1.0)

    def test_the_track_of_a_prism_is_drawn_from_above_alone(self):
        self.run_of('a', False)
        reference = json.loads((self.root / 'a' / 'reference.json').read_text())
        (self.root / 'a' / 'reference.json').write_text(json.dumps({'prism': reference['rtk']}))
        plots = self.plotted('part,technique,setting,repeat,run,truth,judged_by,status\n'
                             '1,vo,,0,a,prism.txt,"prism, horizontal",ok\n')
        self.assertIn('<!-- track of the prism -->', plots['1-routes.svg'])
        self.assertIn('horizontal distance from the prism', plots['1-errors.svg'])
        # From above and in the legend, not from the side.
        self.assertEqual(len(re.findall('stroke-opacity: 0.35', plots['1-routes.svg'])), 2)

    def test_a_path_that_the_results_know_stands_for_the_true_one(self):
        for name in ('a', 'b'):
            self.run_of(name, name == 'b')
            path = self.root / name / 'reference.json'
            path.write_text(json.dumps({'truth': json.loads(path.read_text())['rtk']}))
        plots = self.plotted('part,technique,setting,repeat,run,truth,status\n'
                             '1,vo,,0,a,,ok\n1,rig,,0,b,,ok\n')
        self.assertIn('<!-- true -->', plots['1-routes.svg'])
        self.assertIn('error of the position', plots['1-errors.svg'])

    def test_more_ways_than_colours_differ_in_their_lines(self):
        for i in range(12):
            self.run_of(f'r{i}', False)
        plots = self.plotted('part,technique,setting,repeat,run,truth,status\n' +
                             ''.join(f'1,t{i},,0,r{i},,ok\n' for i in range(12)))
        drawn = re.findall(r'style="fill: none; ?([^"]*stroke-width: 1\.2[^"]*)"',
                           plots['1-routes.svg'])
        # From above, from the side and in the legend.
        self.assertEqual(len(drawn), 3 * 12)
        self.assertEqual(len(set(drawn)), 12)

    def test_more_parts_than_colours_differ_in_their_marks(self):
        plots = self.plotted('part,technique,setting,repeat,run,truth,status,ate_se3_pct\n' +
                             ''.join(f'p{i:02},vo,,0,r{i},,failed,{0.1 * i + 0.1}\n' for i in range(12)))
        # A mark is a shape, kept once, in a colour.
        shapes = dict(re.findall(r'<path id="(\w+)" d="([^"]+)"', plots['spread.svg']))
        used = re.findall(r'<use xlink:href="#(\w+)"[^>]*style="fill: (#\w+)', plots['spread.svg'])
        marks = {(shapes[name], colour) for name, colour in used if colour != '#000000'}
        self.assertEqual(len(marks), 12)

    def test_rocks_are_drawn_where_they_are_and_where_they_were_surveyed(self):
        self.run_of('a', False)
        truth = self.root / 'truth' / 'Part1'
        truth.mkdir(parents=True)
        (truth / 'trajectory.tum').write_text((self.root / 'a' / 'trajectory.tum').read_text())
        (truth.parent / 'rocks.json').write_text(json.dumps({'rocks': [{'x': 5.0, 'y': 1.0, 'width': 0.5}]}))
        (self.root / 'a' / 'evaluation.json').write_text(json.dumps({'surveyed_rocks': {'each': [
            {'found': True, 'x_m': 5.0, 'y_m': 1.0, 'limit_m': 0.3},
            {'found': False, 'x_m': 9.0, 'y_m': 2.0, 'limit_m': 0.3}]}}))
        header = ('ply\nformat binary_little_endian 1.0\nelement vertex 2\n' +
                  ''.join(f'property float {name}\n' for name in 'xyz') +
                  ''.join(f'property uchar {name}\n' for name in ('red', 'green', 'blue')) +
                  'end_header\n')
        points = b''.join(struct.pack('<3f3B', *at, 200, 180, 160) for at in ((4, 1, 0), (6, 1, 0)))
        (self.root / 'a' / 'dense.ply').write_bytes(header.encode() + points)
        plots = self.plotted('part,technique,setting,repeat,run,truth,status\n'
                             f'1,rig,,0,a,{truth / "trajectory.tum"},ok\n')
        name = next(name for name in plots if 'map' in name)
        for label in ('true rocks', 'surveyed rocks, found', 'surveyed rocks, not found'):
            self.assertIn(f'<!-- {label} -->', plots[name])


if __name__ == '__main__':
    sys.exit(0 if unittest.main(exit=False).result.wasSuccessful() else 1)
