// The map as points on the graphics card.
import * as THREE from 'three';
import { grainOf } from './points.js';

const CHUNK = 65536;  // points that are drawn or left out together

const VERTEX = `
attribute vec3 tint;
attribute vec3 known;  // codes of sigma, observations and grain
uniform int mode;
uniform vec2 range;
varying float isLarge;
uniform float finest, thinning, size, pxPerUnit;
varying vec3 shade;

vec3 ramp(float t) {  // viridis, as a polynomial of sixth degree would be; four stops are enough
  t = clamp(t, 0.0, 1.0) * 4.0;
  vec3 a = vec3(0.267, 0.005, 0.329), b = vec3(0.230, 0.322, 0.545), c = vec3(0.128, 0.567, 0.551),
       d = vec3(0.369, 0.789, 0.383), e = vec3(0.993, 0.906, 0.144);
  if (t < 1.0) return mix(a, b, t);
  if (t < 2.0) return mix(b, c, t - 1.0);
  if (t < 3.0) return mix(c, d, t - 2.0);
  return mix(d, e, t - 3.0);
}

void main() {
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * seen;
  float grain = finest * exp2(known.z * 255.0 / 4.0);
  gl_PointSize = clamp(1.3 * grain * thinning * size * pxPerUnit / max(-seen.z, 1e-6), 1.0, 14.0);
  isLarge = gl_PointSize > 5.0 ? 1.0 : 0.0;
  float value = mode == 1 ? position.z : 255.0 * (mode == 2 ? known.x : known.y);
  shade = mode == 0 ? tint : ramp((value - range.x) / max(range.y - range.x, 1e-9));
}`;

const FRAGMENT = `
varying vec3 shade;
varying float isLarge;
void main() {
  vec2 off = gl_PointCoord - 0.5;
  if (isLarge > 0.5 && dot(off, off) > 0.25) discard;  // large points are round
  gl_FragColor = vec4(shade, 1.0);
}`;

function chunkGeometry(level, first, end) {
  const geometry = new THREE.BufferGeometry();
  const known = new Uint8Array(3 * (end - first));
  for (let i = first, k = 0; i < end; ++i) {
    known[k++] = level.sigmas[i];
    known[k++] = level.observations[i];
    known[k++] = level.grains[i];
  }
  const attribute = (array, normalised) => new THREE.BufferAttribute(array, 3, normalised);
  geometry.setAttribute('position', attribute(level.positions.subarray(3 * first, 3 * end), false));
  geometry.setAttribute('tint', attribute(level.colours.subarray(3 * first, 3 * end), true));
  geometry.setAttribute('known', attribute(known, true));
  return geometry;
}

export class Cloud {
  constructor(header) {
    this.header = header;
    this.levels = [];
    this.group = new THREE.Group();
    this.material = new THREE.ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: {
        mode: { value: 0 },
        range: { value: new THREE.Vector2() },
        finest: { value: header.finest_m },
        thinning: { value: 1 },
        size: { value: 1 },
        pxPerUnit: { value: 1 },
      },
    });
  }

  // The coarse levels fill the place of the finer ones until these are there.
  add(level) {
    const group = new THREE.Group();
    for (let first = 0; first < level.count; first += CHUNK) {
      const end = Math.min(first + CHUNK, level.count);
      group.add(new THREE.Points(chunkGeometry(level, first, end), this.material));
    }
    this.levels.push(level);
    this.group.add(group);
    this.fit(this.levels.length);
  }

  get count() {
    return this.levels.reduce((sum, level) => sum + level.count, 0);
  }

  // Draws the first `shown` levels, their points as large as those that are missing leave gaps.
  fit(shown) {
    let count = 0;
    this.group.children.forEach((group, index) => {
      group.visible = index < shown;
      if (index < shown) count += this.levels[index].count;
    });
    this.material.uniforms.thinning.value = Math.sqrt(this.header.count_in_map / Math.max(count, 1));
  }

  // The point whose picture is nearest to (x, y), within `reach`, of several the foremost; px.
  pick(x, y, reach, camera, width, height) {
    const m = new THREE.Matrix4()
      .multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
    let best = null;
    for (const level of this.levels) {
      const p = level.positions;
      for (let i = 0; i < level.count; ++i) {
        const a = p[3 * i], b = p[3 * i + 1], c = p[3 * i + 2];
        const w = m[3] * a + m[7] * b + m[11] * c + m[15];
        if (w <= 0) continue;
        const dx = ((m[0] * a + m[4] * b + m[8] * c + m[12]) / w + 1) * width / 2 - x;
        if (dx > reach || dx < -reach) continue;
        const dy = (1 - (m[1] * a + m[5] * b + m[9] * c + m[13]) / w) * height / 2 - y;
        const off = Math.hypot(dx, dy);
        if (off > reach) continue;
        // A point a little behind but nearer to the middle is what was meant.
        const cost = w * (1 + 0.02 * off);
        if (!best || cost < best.cost) best = { cost, level, index: i };
      }
    }
    if (!best) return null;
    const at = 3 * best.index;
    return {
      position: new THREE.Vector3(...best.level.positions.subarray(at, at + 3)),
      sigma: best.level.sigmas[best.index],
      observations: best.level.observations[best.index],
      grain_m: grainOf(best.level.grains[best.index], this.header.finest_m),
    };
  }
}
