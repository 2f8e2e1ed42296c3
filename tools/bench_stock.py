"""Stock COLMAP on the stereo frames of a rigmap run, step by step, each step measured.

Written for COLMAP 3.8. Poses are camera_from_world as in COLMAP: a quaternion qw qx qy qz and a
translation.
"""
import dataclasses
import json
import os
import pathlib
import struct
import subprocess
import sys
import time

import numpy as np

EYES = ('left', 'right')
NEXT_FRAMES = 3  # a frame is matched with itself and this many after it, in all eye combinations


class StepError(Exception):
    """A step failed; the sentence names its log."""


@dataclasses.dataclass
class Measurement:
    """What one process, with all the children that it waited for, has cost."""
    name: str
    wall_s: float
    cpu_s: float        # user and system
    peak_rss_mb: float  # of the largest single process; at least that of this script
    exit_code: int      # negative: ended by this signal
    log: str


def measure(name, command, log):
    """Runs a command to its end, with all that it says in the file `log`."""
    print(f'bench: {name}', file=sys.stderr)
    log.parent.mkdir(parents=True, exist_ok=True)
    with open(log, 'w') as out:
        out.write('$ ' + ' '.join(map(str, command)) + '\n')
        out.flush()
        start = time.monotonic()
        process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL,
                                   stdout=out, stderr=subprocess.STDOUT)
        try:
            _, status, usage = os.wait4(process.pid, 0)
        except BaseException:
            process.kill()
            raise
        wall_s = time.monotonic() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    return Measurement(name, wall_s, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024,
                       process.returncode, str(log))


@dataclasses.dataclass
class View:
    """An image of a model: camera_from_world."""
    name: str  # left/<stamp_ns>.<ext>
    camera_id: int
    q: np.ndarray
    t: np.ndarray

    def centre(self):
        return -rotation(self.q).T @ self.t


def rotation(q):
    w, x, y, z = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def conjugate(q):
    return q * np.array([1, -1, -1, -1])


def quaternion_product(a, b):
    scalar = a[0] * b[0] - a[1:] @ b[1:]
    return np.concatenate([[scalar], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])])


def read_cameras(model):
    """camera_id -> (COLMAP's model name, its parameters) of a model in text form."""
    lines = [line.split() for line in open(model / 'cameras.txt') if not line.startswith('#')]
    return {int(words[0]): (words[1], [float(word) for word in words[4:]]) for words in lines}


def image_lines(model):
    """The lines of images.txt without its comments: two for each image, the second may be empty."""
    return [line for line in open(model / 'images.txt') if not line.startswith('#')]


def read_views(model):
    """Image name -> View of a model in text form."""
    views = {}
    for line in image_lines(model)[::2]:
        words = line.split(maxsplit=9)
        q, t = np.array(words[1:5], float), np.array(words[5:8], float)
        name = words[9].rstrip('\n')
        views[name] = View(name, int(words[8]), q, t)
    return views


def pairs_of(views):
    """(left, right) of every frame that has both."""
    rights = {pathlib.Path(name).stem: view for name, view in views.items()
              if name.startswith('right/')}
    return [(view, rights[pathlib.Path(name).stem]) for name, view in sorted(views.items())
            if name.startswith('left/') and pathlib.Path(name).stem in rights]


def median_and_spread(distances):
    """The median and 1.4826 MAD / median."""
    median = np.median(distances)
    return median, 1.4826 * np.median(np.abs(distances - median)) / median


def write_scaled(model, factor, out):
    """Writes a text model to another folder with all its lengths multiplied."""
    out.mkdir(parents=True, exist_ok=True)
    (out / 'cameras.txt').write_text((model / 'cameras.txt').read_text())

    def scaled(words):
        return [repr(factor * float(word)) for word in words]

    lines = image_lines(model)
    with open(out / 'images.txt', 'w') as file:
        for image, points in zip(lines[::2], lines[1::2]):
            words = image.rstrip('\n').split(maxsplit=9)
            file.write(' '.join(words[:5] + scaled(words[5:8]) + words[8:]) + '\n' + points)
    with open(out / 'points3D.txt', 'w') as file:
        for line in open(model / 'points3D.txt'):
            if not line.startswith('#'):
                words = line.split()
                file.write(' '.join(words[:1] + scaled(words[1:4]) + words[4:]) + '\n')


def write_tum(views, folder):
    """world_from_left of all left images as folder/trajectory.tum; the stamps are their names."""
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / 'trajectory.tum', 'w') as file:
        for name in sorted(name for name in views if name.startswith('left/')):
            seconds, nanoseconds = divmod(int(pathlib.Path(name).stem), 10**9)
            w, x, y, z = conjugate(views[name].q)
            numbers = ' '.join(f'{number:.12f}' for number in (*views[name].centre(), x, y, z, w))
            file.write(f'{seconds}.{nanoseconds:09d} {numbers}\n')


class StockRun:
    """Stock COLMAP on the images that a rigmap run has linked, with the rig that it has used.

    take_rig, features, matching, mapping, adjustment: to be called in this order; each throws
    StepError.
    """

    def __init__(self, colmap, rigmap_out, out, threads, features):
        self.colmap, self.out = colmap, out
        self.threads, self.feature_count = threads, features
        self.metric_model = rigmap_out / 'sparse'
        self.images = rigmap_out / 'colmap' / 'images'
        self.database = out / 'database.db'
        self.measurements = []
        self.findings = {}  # what there is to say of the models
        self.trajectories = {}  # name -> folder with trajectory.tum

    def take_rig(self):
        """Cameras and right_from_left, in COLMAP's conventions, from the model that rigmap made."""
        if not (self.metric_model / 'images.bin').exists():
            raise StepError(f'expected the rig in {self.metric_model}, which rigmap did not make')
        rig = self._as_text(self.metric_model, self.out / 'rig')
        pairs, cameras = pairs_of(read_views(rig)), read_cameras(rig)
        if not pairs:
            raise StepError(f'expected a frame with both eyes in {self.metric_model}, found none')
        left, right = pairs[0]
        self.cameras = {'left': cameras[left.camera_id], 'right': cameras[right.camera_id]}
        self.right_from_left_q = quaternion_product(right.q, conjugate(left.q))
        self.right_from_left_t = right.t - rotation(self.right_from_left_q) @ left.t

    def _colmap(self, name, *arguments, counted=True):
        """Runs COLMAP; its cost counts unless told otherwise."""
        result = measure(name, [self.colmap, *arguments], self.out / 'logs' / f'{name}.log')
        if counted:
            self.measurements.append(result)
        if result.exit_code != 0:
            raise StepError(f'{arguments[0]} ended with {result.exit_code}, see {result.log}')
        return result

    def _as_text(self, model, text):
        text.mkdir(parents=True, exist_ok=True)
        self._colmap(f'convert_{text.name}', 'model_converter', '--input_path', model,
                     '--output_path', text, '--output_type', 'TXT', counted=False)
        return text

    def _names(self, eye):
        return sorted(f'{eye}/{path.name}' for path in (self.images / eye).iterdir())

    def features(self):
        """Two runs, as one run takes the parameters of one camera."""
        for eye in EYES:
            image_list = self.out / f'{eye}.txt'
            image_list.write_text('\n'.join(self._names(eye)) + '\n')
            model, parameters = self.cameras[eye]
            self._colmap(f'features_{eye}', 'feature_extractor', '--database_path', self.database,
                         '--image_path', self.images, '--image_list_path', image_list,
                         '--ImageReader.single_camera_per_folder', 1,
                         '--ImageReader.camera_model', model,
                         '--ImageReader.camera_params', ','.join(map(repr, parameters)),
                         '--SiftExtraction.max_num_features', self.feature_count,
                         '--SiftExtraction.use_gpu', 0,
                         '--SiftExtraction.num_threads', self.threads)

    def matching(self):
        frames = list(zip(self._names('left'), self._names('right')))
        pairs = list(frames)
        for i, frame in enumerate(frames):
            for other in frames[i + 1:i + 1 + NEXT_FRAMES]:
                pairs += [(a, b) for a in frame for b in other]
        pair_list = self.out / 'pairs.txt'
        pair_list.write_text(''.join(f'{a} {b}\n' for a, b in pairs))
        self._colmap('matching', 'matches_importer', '--database_path', self.database,
                     '--match_list_path', pair_list, '--match_type', 'pairs',
                     '--SiftMatching.use_gpu', 0, '--SiftMatching.num_threads', self.threads)

    def mapping(self):
        models = self.out / 'models'
        models.mkdir()
        log = self._colmap('mapping', 'mapper', '--database_path', self.database, '--image_path',
                           self.images, '--output_path', models,
                           '--Mapper.ba_refine_focal_length', 0,
                           '--Mapper.ba_refine_principal_point', 0,
                           '--Mapper.ba_refine_extra_params', 0,
                           '--Mapper.num_threads', self.threads).log
        sizes = {model: struct.unpack('<Q', (model / 'images.bin').read_bytes()[:8])[0]
                 for model in models.iterdir()}
        if not sizes:
            raise StepError(f'mapper made no model, see {log}')
        largest = max(sizes, key=sizes.get)
        self.findings = {'models': len(sizes), 'registered_images': sizes[largest],
                         'images': sum(len(self._names(eye)) for eye in EYES)}
        self._scale(self._as_text(largest, self.out / 'unscaled'))

    def _scale(self, model):
        """To metres by the median left-right distance; in own code, so it costs COLMAP nothing."""
        pairs = pairs_of(read_views(model))
        if not pairs:
            raise StepError(f'no frame has both eyes in {model}, so the model has no scale')
        distances = [np.linalg.norm(left.centre() - right.centre()) for left, right in pairs]
        median, spread = median_and_spread(np.array(distances))
        factor = float(np.linalg.norm(self.right_from_left_t) / median)
        self.findings |= {'metres_per_model_unit': factor, 'relative_spread': float(spread)}
        write_scaled(model, factor, self.out / 'mapper')
        self._keep('mapper')

    def adjustment(self):
        """All intrinsics and the rig held; this program has no option for the threads."""
        camera_ids = {name.split('/')[0]: view.camera_id
                      for name, view in read_views(self.out / 'mapper').items()}
        rig = self.out / 'rig.json'
        rig.write_text(json.dumps([{
            'ref_camera_id': camera_ids['left'],
            'cameras': [
                {'camera_id': camera_ids['left'], 'image_prefix': 'left/',
                 'rel_qvec': [1, 0, 0, 0], 'rel_tvec': [0, 0, 0]},
                {'camera_id': camera_ids['right'], 'image_prefix': 'right/',
                 'rel_qvec': self.right_from_left_q.tolist(),
                 'rel_tvec': self.right_from_left_t.tolist()}]}], indent=1))
        adjusted = self.out / 'adjusted'
        adjusted.mkdir()
        self._colmap('adjustment', 'rig_bundle_adjuster', '--input_path', self.out / 'mapper',
                     '--output_path', adjusted, '--rig_config_path', rig,
                     '--estimate_rig_relative_poses', 0,
                     '--RigBundleAdjustment.refine_relative_poses', 0,
                     '--BundleAdjustment.refine_focal_length', 0,
                     '--BundleAdjustment.refine_principal_point', 0,
                     '--BundleAdjustment.refine_extra_params', 0)
        self._as_text(adjusted, self.out / 'rig_adjusted')
        self._keep('rig_adjusted')

    def _keep(self, name):
        write_tum(read_views(self.out / name), self.out / name)
        self.trajectories[name] = self.out / name
