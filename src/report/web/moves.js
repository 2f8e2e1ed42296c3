// How the camera of the 3-D view moves: methods of View.
import * as THREE from 'three';
import * as marks from './path.js';

export const FIELD_OF_VIEW_DEG = 50;

export const moves = {
  seeFrom(name) {
    this.stopFlight();
    const box = new THREE.Vector3(...this.world.high).sub(new THREE.Vector3(...this.world.low));
    const narrow = Math.min(1, (this.place.clientWidth || 1) / (this.place.clientHeight || 1));
    const away = 0.5 * Math.hypot(box.x, box.y) / Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360) / narrow;
    const { poses } = this.world;
    this.controls.target.copy(this.centre);
    if (name === 'top') {
      // x to the right, y up, as in the pictures.
      const perHeight = 2 * Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360);
      const aspect = (this.place.clientWidth || 1) / (this.place.clientHeight || 1);
      const above = 1.06 * Math.max(box.y, box.x / aspect) / perHeight + 0.5 * box.z;
      this.camera.position.copy(this.centre).add(new THREE.Vector3(0, -0.001 * above, above));
    } else if (name === 'path' && poses) {
      const start = marks.positionOf(poses, 0);
      const ahead = new THREE.Vector3(0, 0, 1).applyQuaternion(marks.rotationOf(poses, 0));
      ahead.z = 0;
      ahead.normalize();
      this.camera.position.copy(start).addScaledVector(ahead, -4 * this.step);
      this.camera.position.z += 3 * this.step;
      this.controls.target.copy(start).addScaledVector(ahead, 6 * this.step);
      this.controls.target.z -= this.step;
    } else {
      this.camera.position.copy(this.centre).add(new THREE.Vector3(-0.62, -0.42, 0.5).multiplyScalar(away * 1.05));
    }
    this.controls.update();
    this.paint();
  },

  // Along the path, from somewhat behind and above it, in 20 s at a walking pace or faster.
  fly() {
    const { poses } = this.world;
    if (!poses || poses.x.length < 2) return;
    if (this.flight) return this.stopFlight();
    const points = poses.x.map((_, i) => marks.positionOf(poses, i));
    const curve = new THREE.CatmullRomCurve3(points.filter((_, i) => i % Math.ceil(points.length / 200) === 0), false, 'centripetal');
    const length = Math.max(curve.getLength(), 1e-3);
    const seconds = Math.min(60, Math.max(12, length / 1.5));
    const behind = Math.min(Math.max(2.5 * this.step, 0.08 * length), 8);
    let first;
    const go = (now) => {
      first ??= now;
      const share = (now - first) / 1000 / seconds;
      if (share >= 1) return this.stopFlight();
      const at = curve.getPointAt(share), ahead = curve.getTangentAt(share);
      ahead.z = 0;
      ahead.normalize();
      this.camera.position.copy(at).addScaledVector(ahead, -behind);
      this.camera.position.z += 0.55 * behind;
      this.controls.target.copy(at).addScaledVector(ahead, 1.2 * behind);
      this.controls.target.z -= 0.4 * behind;
      this.camera.lookAt(this.controls.target);
      this.paint();
      this.flight = requestAnimationFrame(go);
    };
    this.flight = requestAnimationFrame(go);
    this.panel.flying(true);
  },

  stopFlight() {
    if (!this.flight) return;
    cancelAnimationFrame(this.flight);
    this.flight = null;
    this.panel.flying(false);
  },

  zoomTo(point) {
    const way = point.clone().sub(this.controls.target);
    const from = this.camera.position.clone(), target = this.controls.target.clone();
    const to = point.clone().add(from.clone().sub(target).multiplyScalar(0.35));
    let first;
    const go = (now) => {
      first ??= now;
      const t = Math.min(1, (now - first) / 350), s = t * t * (3 - 2 * t);
      this.controls.target.copy(target).addScaledVector(way, s);
      this.camera.position.lerpVectors(from, to, s);
      this.controls.update();
      this.paint();
      if (t < 1) requestAnimationFrame(go);
    };
    requestAnimationFrame(go);
  },

  dolly(factor) {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.paint();
  },

  turn(angle) {
    this.camera.position.sub(this.controls.target)
      .applyAxisAngle(this.camera.up, angle).add(this.controls.target);
    this.controls.update();
    this.paint();
  },
};
