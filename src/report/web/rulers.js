// What tells directions and lengths in the 3-D view: the world's axes, and a bar of a round length.
import * as THREE from 'three';

const SVG = 'http://www.w3.org/2000/svg';
const REACH_PX = 26, MIDDLE_PX = 36;
const BAR_PX = 110;
const AXES = [['x', '#ff6b6b'], ['y', '#6bd66b'], ['z', '#6ba8ff']];

function draw(tag, attributes, parent) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  parent.append(made);
  return made;
}

// The longest of 1, 2 or 5 times a power of ten that is no longer.
export function roundLength(length_m) {
  const power = 10 ** Math.floor(Math.log10(length_m));
  const first = length_m / power;
  return power * (first >= 5 ? 5 : first >= 2 ? 2 : 1);
}

function lengthName(length_m) {
  if (length_m < 0.0095) return `${+(1000 * length_m).toPrecision(1)} mm`;
  if (length_m < 0.95) return `${+(100 * length_m).toPrecision(1)} cm`;
  return length_m < 950 ? `${+length_m.toPrecision(1)} m` : `${+(length_m / 1000).toPrecision(1)} km`;
}

export function makeRulers(stage) {
  const box = document.createElement('div');
  box.className = 'rulers';
  const compass = draw('svg', { width: 2 * MIDDLE_PX, height: 2 * MIDDLE_PX, role: 'img' }, box);
  compass.setAttribute('aria-label', 'axes of the world');
  const axes = AXES.map(([name, colour]) => ({
    line: draw('line', { x1: MIDDLE_PX, y1: MIDDLE_PX, stroke: colour, 'stroke-width': 2.5 }, compass),
    text: Object.assign(draw('text', { fill: colour, 'text-anchor': 'middle' }, compass), { textContent: name }),
  }));
  const bar = document.createElement('span');
  bar.className = 'length';
  box.append(bar);
  stage.append(box);

  // `pxPerMetre`: of what is as far as the point that the camera turns about.
  return function update(camera, pxPerMetre) {
    const toCamera = camera.quaternion.clone().invert();
    axes.forEach(({ line, text }, i) => {
      const axis = new THREE.Vector3().setComponent(i, 1).applyQuaternion(toCamera);
      const x = MIDDLE_PX + REACH_PX * axis.x, y = MIDDLE_PX - REACH_PX * axis.y;
      line.setAttribute('x2', x);
      line.setAttribute('y2', y);
      text.setAttribute('x', MIDDLE_PX + 1.25 * REACH_PX * axis.x);
      text.setAttribute('y', MIDDLE_PX - 1.25 * REACH_PX * axis.y + 4);
    });
    const length_m = roundLength(BAR_PX / pxPerMetre);
    bar.style.width = `${length_m * pxPerMetre}px`;
    bar.textContent = lengthName(length_m);
  };
}
