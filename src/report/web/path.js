// What is drawn beside the map: the path, its cameras and sigmas, the true path, fixes, rocks.
import * as THREE from 'three';
import { Line2 } from 'three/examples/jsm/lines/Line2.js';
import { LineGeometry } from 'three/examples/jsm/lines/LineGeometry.js';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';

const MOST_CAMERAS = 600;

export const COLOURS = { path: 0xff7a1a, guessed: 0xd92b2b, truth: 0x19b36b, rtk: 0x2b8cff, rock: 0xffd23f, sigma: 0xff4fa3 };

function lines(vertices, colour, Kind = THREE.LineSegments) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(vertices, 3));
  return new Kind(geometry, new THREE.LineBasicMaterial({ color: colour }));
}

// All coordinates of the data less the map's origin.
export function shifted(data, origin) {
  const poses = data.poses && {
    ...data.poses,
    x: data.poses.x.map((v) => v - origin[0]),
    y: data.poses.y.map((v) => v - origin[1]),
    z: data.poses.z.map((v) => v - origin[2]),
    // null where nothing is known, which is not zero
    ...Object.fromEntries(['sx', 'sy', 'sz', 'sr'].map((name) => [name, data.poses[name].map((v) => v ?? NaN)])),
  };
  const shift = (p) => [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]];
  return {
    poses,
    truth: (data.truth ?? []).map(shift),
    rtk: (data.rtk ?? []).map(shift),
    rocks: (data.rocks ?? []).map((r) => ({ ...r, x: r.x - origin[0], y: r.y - origin[1], top: r.top - origin[2] })),
    low: shift(data.bounds.low),
    high: shift(data.bounds.high),
  };
}

export const positionOf = (poses, i) => new THREE.Vector3(poses.x[i], poses.y[i], poses.z[i]);
export const rotationOf = (poses, i) => new THREE.Quaternion(...poses.q.slice(4 * i, 4 * i + 4));

// As wide on the screen from near and from afar: scenes are of metres or of kilometres.
function fatLine(points, width_px, colour) {
  const geometry = new LineGeometry();
  geometry.setPositions(points.flatMap((p) => p.toArray()));
  return new Line2(geometry, new LineMaterial({ color: colour, linewidth: width_px }));
}

const apart = (points) => points.filter((p, i) => i === 0 || p.distanceTo(points[i - 1]) > 1e-6);

export function polyline(points, width_px, colour) {
  const vectors = apart(points.map((p) => new THREE.Vector3(...p)));
  return vectors.length < 2 ? new THREE.Group() : fatLine(vectors, width_px, colour);
}

export function pathLine(poses, width_px) {
  return polyline(poses.x.map((_, i) => positionOf(poses, i).toArray()), width_px, COLOURS.path);
}

function disc() {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 32;
  const context = canvas.getContext('2d');
  context.fillStyle = '#fff';
  context.arc(16, 16, 15, 0, 2 * Math.PI);
  context.fill();
  return new THREE.CanvasTexture(canvas);
}

export function dots(points, width_px, colour) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(points.flat(), 3));
  return new THREE.Points(geometry, new THREE.PointsMaterial({
    color: colour, size: width_px, sizeAttenuation: false, map: disc(), alphaTest: 0.5 }));
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

// As large on the screen from near and from afar.
function label(text) {
  const height = 0.026;  // of the view
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
    map: new THREE.CanvasTexture(canvas), depthTest: false, transparent: true, sizeAttenuation: false }));
  sprite.scale.set(4 * height, height, 1);
  return sprite;
}

// A ring around each rock, the highest with their heights: labels, the highest first.
export function rockMarks(rocks, extent) {
  const group = new THREE.Group(), labels = [];
  const vertices = [];
  rocks.forEach((rock, index) => {
    const on = (t) => [rock.x + 0.6 * rock.width * Math.cos(t), rock.y + 0.6 * rock.width * Math.sin(t), rock.top];
    for (let k = 0; k < 24; ++k) vertices.push(...on(k * Math.PI / 12), ...on((k + 1) * Math.PI / 12));
    if (index >= 12) return;
    const sprite = label(`${rock.height.toFixed(2)} m`);
    sprite.position.set(rock.x, rock.y, rock.top + extent / 50);
    group.add(sprite);
    labels.push(sprite);
  });
  group.add(lines(vertices, COLOURS.rock));
  return { group, labels };
}
