// The 3-D view: the map with what was driven over it, to be turned, measured and flown through.
import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { Cloud } from './cloud.js';
import { Crowd } from './crowd.js';
import { lengthText, measure, sigmaText } from './measure.js';
import { observationsOf, sigmaOf, unpackLevel } from './points.js';
import { FIELD_OF_VIEW_DEG, moves } from './moves.js';
import * as marks from './path.js';
import { makePanel } from './panel.js';
import { makeRulers } from './rulers.js';

const PICK_REACH_PX = 6, CAMERA_REACH_PX = 14;
const SLOW_FRAME_MS = 50;

class View {
  constructor(place, data, renderer) {
    this.data = data;
    this.place = place;
    this.renderer = renderer;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW_DEG, 1, 0.01, 1000);
    this.camera.up.set(0, 0, 1);
    this.world = marks.shifted(data, data.points?.origin ?? [0, 0, 0]);
    this.centre = new THREE.Vector3(...this.world.low).add(new THREE.Vector3(...this.world.high)).multiplyScalar(0.5);
    this.extent = Math.max(new THREE.Vector3(...this.world.low).distanceTo(new THREE.Vector3(...this.world.high)), 0.2);
    this.controls = new OrbitControls(this.camera, renderer.domElement);
    this.controls.zoomToCursor = true;
    this.controls.keyPanSpeed = 30;
    this.controls.maxPolarAngle = 0.49 * Math.PI;  // not below the ground
    this.controls.listenToKeyEvents(renderer.domElement);
    this.controls.addEventListener('change', () => this.paint());
    this.controls.addEventListener('start', () => this.stopFlight());
    this.layers = {};
    this.picked = [];
    this.clickMeasures = true;
    this.work = [];  // of each frame painted, what the code took, ms
    if (data.points) {
      this.cloud = new Cloud(data.points);
      this.addLayer('map', 'Map', this.cloud.group);
    }
    this.addMarks();
    this.measured = new THREE.Group();
    this.scene.add(this.measured);
    this.seeFrom('oblique');
  }

  addLayer(id, name, object, visible = true, colour = null) {
    object.visible = visible;
    this.layers[id] = { id, name, object, colour };
    this.scene.add(object);
  }

  addMarks() {
    const { poses, truth, rtk, rocks } = this.world;
    if (poses) {
      const path = this.data.pathLength > 0 ? this.data.pathLength / Math.max(poses.x.length - 1, 1) : this.extent / 20;
      this.step = Math.max(path, this.extent / 300);
      this.addLayer('path', 'Path', marks.pathLine(poses, 3), true, marks.COLOURS.path);
      this.addLayer('cameras', 'Cameras', marks.frustums(poses, this.data.camera, Math.min(0.8 * this.step, this.extent / 25)), true, marks.COLOURS.path);
      const rings = marks.sigmaRings(poses, this.extent);
      if (rings.times > 0) {
        this.addLayer('sigmas', `Sigmas \u00d7 ${rings.times.toLocaleString('en')}`, rings.group, false, marks.COLOURS.sigma);
      }
    }
    if (truth.length) this.addLayer('truth', 'True path', marks.polyline(truth, 5, marks.COLOURS.truth), true, marks.COLOURS.truth);
    this.crowd = new Crowd();
    if (rtk.length) this.addLayer('rtk', 'RTK fixes', this.crowd.addDots(rtk, marks.COLOURS.rtk), true, marks.COLOURS.rtk);
    if (rocks.length) {
      const { group, labels } = marks.rockMarks(rocks, this.extent);
      this.crowd.addLabels(labels);
      this.addLayer('rocks', 'Rocks', group, true, marks.COLOURS.rock);
    }
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.paint();
  }

  paint() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame((now) => {
      this.waiting = false;
      this.draw(now);
    });
  }

  draw(now) {
    const before = performance.now();
    const toTarget = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = Math.max(toTarget * 0.005, this.extent * 1e-5);
    this.camera.far = toTarget + 4 * this.extent;
    this.camera.updateProjectionMatrix();
    const pxPerUnit = this.place.clientHeight / (2 * Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360));
    if (this.cloud) this.cloud.material.uniforms.pxPerUnit.value = pxPerUnit * this.renderer.getPixelRatio();
    this.rulers?.(this.camera, pxPerUnit / toTarget);
    this.crowd.makeRoom(pxPerUnit / toTarget, (point) => this.project(point));
    this.renderer.render(this.scene, this.camera);
    this.work.push(performance.now() - before);
    if (this.work.length > 200) this.work.shift();
    this.spare(now);
  }

  // While it moves on a machine that is too slow for all points, the coarse levels stand for them.
  spare(now) {
    if (!this.cloud) return;
    const levels = this.cloud.levels.length;
    const gap = now - (this.lastFrame ?? now);
    this.lastFrame = now;
    this.shown = Math.min(this.shown ?? levels, levels);
    if (gap > SLOW_FRAME_MS && gap < 1000 && this.shown > 1) {
      this.shown -= 1;
      this.cloud.fit(this.shown);
    }
    clearTimeout(this.settle);
    if (this.shown < levels) {
      this.settle = setTimeout(() => {
        this.shown = levels;
        this.lastFrame = undefined;
        this.cloud.fit(levels);
        this.paint();
      }, 250);
    }
  }

  // Of a point of the world, where it is in the view, px; NaN for what lies behind the viewer.
  project(point) {
    this.camera.updateMatrixWorld();
    const seen = new THREE.Vector3(...point).applyMatrix4(this.camera.matrixWorldInverse);
    if (seen.z >= 0) return [NaN, NaN]; // behind the viewer
    seen.applyMatrix4(this.camera.projectionMatrix);
    return [(seen.x + 1) / 2 * this.place.clientWidth, (1 - seen.y) / 2 * this.place.clientHeight];
  }

  cameraAt(x, y) {
    const { poses } = this.world;
    if (!poses || !this.layers.cameras.object.visible) return null;
    let best = null, least = CAMERA_REACH_PX;
    for (const i of marks.shownCameras(poses)) {
      const [u, v] = this.project([poses.x[i], poses.y[i], poses.z[i]]);
      const off = Math.hypot(u - x, v - y);
      if (off < least) [best, least] = [i, off];
    }
    return best;
  }

  pointAt(x, y) {
    if (!this.cloud || !this.cloud.group.visible) return null;
    this.camera.updateMatrixWorld();
    return this.cloud.pick(x, y, PICK_REACH_PX, this.camera, this.place.clientWidth, this.place.clientHeight);
  }

  click(x, y) {
    const camera = this.cameraAt(x, y);
    if (camera !== null) return this.panel.showCamera(camera);
    const point = this.pointAt(x, y);
    if (!point) return;
    if (this.picked.length === 2) this.picked = [];
    this.picked.push(point);
    this.showPicked();
  }

  showPicked() {
    this.measured.clear();
    const points = this.picked.map(({ position }) => position.toArray());
    if (points.length) this.measured.add(marks.dots(points, 10, 0xffffff));
    if (points.length === 2) this.measured.add(marks.polyline(points, 2, 0xffffff));
    const [one, other] = this.picked;
    const height = one && one.position.z + (this.data.points?.origin[2] ?? 0);
    let text = '';
    if (other) {
      const found = measure(one, other, this.world.poses, this.data.scale);
      this.lastMeasured = found;
      text = `Distance ${lengthText(found)}, height difference ${(other.position.z - one.position.z).toFixed(3)} m`;
    } else if (one) {
      const sigma = sigmaOf(one.sigma);
      const [x, y] = one.position.toArray().map((value, axis) => value + (this.data.points?.origin[axis] ?? 0));
      text = `x ${x.toFixed(2)}, y ${y.toFixed(2)}, height ${height.toFixed(3)} m of the map's world, ` +
        `${Number.isFinite(sigma) ? `sigma ${sigmaText(sigma)}, ` : ''}seen in ${observationsOf(one.observations)} depth pixels. Click a second point to measure.`;
    }
    this.panel.say(text);
    this.paint();
  }

  clearPicked() {
    this.picked = [];
    this.showPicked();
  }

  listen() {
    const canvas = this.renderer.domElement;
    let down = null;
    const at = (event) => {
      const box = canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    canvas.addEventListener('pointerdown', (event) => {
      down = event.isPrimary && event.button === 0 ? { at: at(event) } : null;
    });
    canvas.addEventListener('pointerup', (event) => {
      if (!down) return;
      const [x, y] = at(event);
      const moved = Math.hypot(x - down.at[0], y - down.at[1]);
      if (moved < 5) this.click(x, y);
      down = null;
    });
    canvas.addEventListener('dblclick', (event) => {
      const point = this.pointAt(...at(event));
      this.clearPicked();
      if (point) this.zoomTo(point.position);
    });
    canvas.addEventListener('keydown', (event) => this.key(event));
    new ResizeObserver(() => this.resize()).observe(this.place);
  }

  key(event) {
    const does = {
      t: () => this.seeFrom('top'), o: () => this.seeFrom('oblique'), p: () => this.seeFrom('path'),
      f: () => this.fly(), Escape: () => { this.stopFlight(); this.clearPicked(); },
      '+': () => this.dolly(0.8), '=': () => this.dolly(0.8), '-': () => this.dolly(1.25),
      a: () => this.turn(0.1), d: () => this.turn(-0.1),
    }[event.key];
    if (!does || event.ctrlKey || event.metaKey || event.altKey) return;
    does();
    event.preventDefault();
  }

  // Coarse to fine; between two levels the page may answer.
  async load() {
    for (const header of this.data.points?.levels ?? []) {
      const level = await unpackLevel(header, this.data.points);
      if (!level) continue;
      this.cloud.add(level);
      this.shown = this.cloud.levels.length;
      this.lastFrame = undefined;
      this.panel.loaded(this.cloud.count, this.data.points);
      this.paint();
      await new Promise((resolve) => setTimeout(resolve, 0));
      this.shownAt ??= performance.now();
    }
    this.ready = true;
  }
}

Object.assign(View.prototype, moves);

function makeRenderer() {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('webgl2', { antialias: true, powerPreference: 'high-performance' });
  if (!context) return null;
  return new THREE.WebGLRenderer({ canvas, context, antialias: true });
}

// The text around the points' scripts must have been read before the finest of them are asked for.
function documentRead() {
  if (document.readyState !== 'loading') return Promise.resolve();
  return new Promise((resolve) => document.addEventListener('DOMContentLoaded', resolve, { once: true }));
}

export async function openView(data) {
  const section = document.getElementById('view3d');
  if (!section || !data.bounds) return;
  let renderer = null;
  try {
    renderer = makeRenderer();
  } catch {
    renderer = null;
  }
  if (!renderer) {
    section.classList.add('without-webgl');
    return;
  }
  const place = section.querySelector('.stage');
  section.classList.add('with-webgl');
  renderer.setClearColor(0x12161b);
  const canvas = renderer.domElement;
  canvas.tabIndex = 0;
  canvas.setAttribute('aria-label', '3-D view of the map; arrow keys move, a and d turn, plus and minus zoom');
  place.append(canvas);
  const view = new View(place, data, renderer);
  view.panel = makePanel(section, view);
  view.rulers = makeRulers(place);
  view.resize();
  view.seeFrom('oblique');
  view.listen();
  window.rigmapView = view;
  await documentRead();
  await view.load();
}
