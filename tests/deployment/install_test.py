#!/usr/bin/python3
"""Installs a build into a prefix and packs it, and runs what lies there.

usage: install_test.py BUILD VERSION
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

BUILD, VERSION = (sys.argv.pop(1) for _ in range(2)) if len(sys.argv) > 2 else (None, None)


def run(*command, **more):
    ended = subprocess.run(command, capture_output=True, text=True, **more)
    if ended.returncode != 0:
        raise AssertionError(f'{command}: {ended.returncode}\n{ended.stdout}{ended.stderr}')
    return ended.stdout


class Installed(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def check_programs(self, prefix):
        self.assertTrue(run(prefix / 'bin/rigmap', '--version', cwd='/').startswith(VERSION))
        link = self.root / 'link'
        link.symlink_to(prefix / 'bin/rigmap')
        self.assertTrue(run(link, '--version').startswith(VERSION))
        # Without --rig it takes the rig file that was installed with it.
        run(prefix / 'bin/rigmap-simulate', '--scene', 'flat-sand', '--path', 'straight', '--pairs', '3',
            '--spacing', '0.2', '--seed', '1', '--image-scale', '0.1', '--out', self.root / 'drive',
            '--quiet', cwd='/')
        self.assertTrue((prefix / 'share/rigmap/config/rigs/loccam.yaml').is_file())
        for name in ('Snakefile', 'job_arguments.py'):
            self.assertTrue((prefix / 'share/rigmap/workflows' / name).is_file())
        self.assertTrue(os.access(prefix / 'share/rigmap/workflows/part-job', os.X_OK))

    def test_runs_from_a_prefix(self):
        run('cmake', '--install', BUILD, '--prefix', self.root / 'prefix')
        self.check_programs(self.root / 'prefix')

    def test_runs_from_a_debian_package(self):
        for program in ('dpkg-shlibdeps', 'dpkg-deb', 'cpack'):
            if subprocess.run(['which', program], capture_output=True).returncode != 0:
                self.skipTest(f'{program} is not installed')
        run('cpack', '--config', f'{BUILD}/CPackConfig.cmake', '-B', self.root / 'packed', cwd=BUILD)
        package, = (self.root / 'packed').glob('rigmap_*.deb')
        fields = run('dpkg-deb', '--field', package, 'Depends')
        for needed in ('colmap (>= 3.8)', 'libgdal', 'libgeographiclib', 'libopencv-core'):
            self.assertIn(needed, fields)
        run('dpkg-deb', '--extract', package, self.root / 'unpacked')
        self.check_programs(self.root / 'unpacked/usr')


if __name__ == '__main__':
    result = unittest.main(exit=False).result
    for test, why in result.skipped:
        print(f'[  SKIPPED ] {test.id()}: {why}')
    sys.exit(0 if result.wasSuccessful() else 1)
