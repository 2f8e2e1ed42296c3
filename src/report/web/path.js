// What is drawn beside the map: the path, its cameras and sigmas, the true path, fixes, rocks.
import * as THREE from 'three';

const MOST_CAMERAS = 600;

export const COLOURS = { path: 0xff7a1a, guessed: 0xd92b2b, truth: 0x19b36b, rtk: 0x2b8cff, rock: 0xffd23f, sigma: 0xff4fa3 };

function lines(vertices, colour, Kind = THREE.LineSegments) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(vertices, 3));
  return new Kind(geometry, new THREE.LineBasicMaterial({ color: colour }));
}

export const positionOf = (poses, i) => new THREE.Vector3(poses.x[i], poses.y[i], poses.z[i]);
export const rotationOf = (poses, i) => new THREE.Quaternion(...poses.q.slice(4 * i, 4 * i + 4));

// A tube is seen from afar, where a line of one pixel is not.
function tube(points, radius, colour) {
  const curve = new THREE.CatmullRomCurve3(points, false, 'centripetal');
  const segments = Math.min(4000, 4 * points.length);
  return new THREE.Mesh(new THREE.TubeGeometry(curve, segments, radius, 6),
    new THREE.MeshBasicMaterial({ color: colour }));
}

export function pathLine(poses, radius) {
  const points = poses.x.map((_, i) => positionOf(poses, i))
    .filter((p, i, all) => i === 0 || p.distanceTo(all[i - 1]) > 1e-6);
  return points.length < 2 ? new THREE.Group() : tube(points, radius, COLOURS.path);
}

export function polyline(points, radius, colour) {
  const vectors = points.map((p) => new THREE.Vector3(...p))
    .filter((p, i, all) => i === 0 || p.distanceTo(all[i - 1]) > 1e-6);
  return vectors.length < 2 ? new THREE.Group() : tube(vectors, radius, colour);
}

export function dots(points, radius, colour) {
  const mesh = new THREE.InstancedMesh(new THREE.SphereGeometry(radius, 10, 8),
    new THREE.MeshBasicMaterial({ color: colour }), points.length);
  const matrix = new THREE.Matrix4();
  points.forEach((p, i) => mesh.setMatrixAt(i, matrix.makeTranslation(...p)));
  return mesh;
}

export function shownCameras(poses) {
  const all = poses.x.map((_, i) => i).filter((i) => poses.keyframe[i]);
  const every = Math.ceil(all.length / MOST_CAMERAS);
  return all.filter((_, k) => k % every === 0);
}

export function frustums(poses, camera, size) {
  const group = new THREE.Group();
  const { width, height, fx, fy, cx, cy } = camera;
  const corners = [[0, 0], [width, 0], [width, height], [0, height]]
    .map(([u, v]) => new THREE.Vector3((u - cx) / fx, (v - cy) / fy, 1).multiplyScalar(size));
  const kinds = { sure: [], guessed: [] };
  for (const i of shownCameras(poses)) {
    const centre = positionOf(poses, i), q = rotationOf(poses, i);
    const at = corners.map((corner) => corner.clone().applyQuaternion(q).add(centre));
    const into = poses.source[i] === 'adjusted' ? kinds.sure : kinds.guessed;
    at.forEach((corner, k) => into.push(...centre, ...corner, ...corner, ...at[(k + 1) % 4]));
  }
  group.add(lines(kinds.sure, COLOURS.path), lines(kinds.guessed, COLOURS.guessed));
  return group;
}

// A ring in the horizontal plane and an upright bar for each shown camera, as many times enlarged
// as the largest is a fortieth of the scene.
export function sigmaRings(poses, extent) {
  const largest = Math.max(...poses.sx, ...poses.sy, ...poses.sz);
  const group = new THREE.Group();
  if (!(largest > 0)) return { group, times: 0 };
  const power = 10 ** Math.floor(Math.log10(extent / 40 / largest));
  const times = Math.max(1, Math.floor(extent / 40 / largest / power) * power);
  const vertices = [];
  const cameras = shownCameras(poses);
  const every = Math.ceil(cameras.length / 150);
  for (const i of cameras.filter((_, k) => k % every === 0)) {
    const on = (t) => [poses.x[i] + times * poses.sx[i] * Math.cos(t),
      poses.y[i] + times * poses.sy[i] * Math.sin(t), poses.z[i]];
    for (let k = 0; k < 24; ++k) vertices.push(...on(k * Math.PI / 12), ...on((k + 1) * Math.PI / 12));
    vertices.push(poses.x[i], poses.y[i], poses.z[i] - times * poses.sz[i],
      poses.x[i], poses.y[i], poses.z[i] + times * poses.sz[i]);
  }
  group.add(lines(vertices, COLOURS.sigma));
  return { group, times };
}

function label(text, height) {
  const canvas = document.createElement('canvas');
  canvas.width = 256;
  canvas.height = 64;
  const context = canvas.getContext('2d');
  context.font = '600 34px system-ui, sans-serif';
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.lineWidth = 8;
  context.strokeStyle = 'rgba(0,0,0,0.75)';
  context.strokeText(text, 128, 32);
  context.fillStyle = '#ffe28a';
  context.fillText(text, 128, 32);
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({
    map: new THREE.CanvasTexture(canvas), depthTest: false, transparent: true }));
  sprite.scale.set(4 * height, height, 1);
  return sprite;
}

// A ring around each rock, the highest with their heights.
export function rockMarks(rocks, extent) {
  const group = new THREE.Group();
  const vertices = [];
  rocks.forEach((rock, index) => {
    const on = (t) => [rock.x + 0.6 * rock.width * Math.cos(t), rock.y + 0.6 * rock.width * Math.sin(t), rock.top];
    for (let k = 0; k < 24; ++k) vertices.push(...on(k * Math.PI / 12), ...on((k + 1) * Math.PI / 12));
    if (index >= 12) return;
    const sprite = label(`${rock.height.toFixed(2)} m`, extent / 45);
    sprite.position.set(rock.x, rock.y, rock.top + extent / 50);
    group.add(sprite);
  });
  group.add(lines(vertices, COLOURS.rock));
  return group;
}
