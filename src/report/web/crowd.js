// Marks that would cover each other, or the map, where they are seen from afar.
import { dots } from './path.js';

const DOT_PX = 9, LEAST_DOT_PX = 2.5;
const LABEL_WIDTH_PX = 64, LABEL_HEIGHT_PX = 18;

// Between points that follow each other, the median.
function usualGap(points) {
  const gaps = points.slice(1).map((p, i) => Math.hypot(p[0] - points[i][0], p[1] - points[i][1], p[2] - points[i][2]));
  return gaps.sort((a, b) => a - b)[gaps.length >> 1] ?? Infinity;
}

export class Crowd {
  dots = [];
  labels = [];

  addDots(points, colour) {
    const object = dots(points, DOT_PX, colour);
    this.dots.push({ object, gap_m: usualGap(points) });
    return object;
  }

  // The most important first.
  addLabels(sprites) {
    this.labels.push(...sprites);
  }

  // Dots shrink to a line, and of labels that would cover each other the first stays. `project`: a
  // point of the world to px.
  makeRoom(pxPerMetre, project) {
    for (const { object, gap_m } of this.dots) {
      object.material.size = Math.min(DOT_PX, Math.max(LEAST_DOT_PX, 0.7 * gap_m * pxPerMetre));
    }
    const taken = [];
    for (const label of this.labels) {
      const [u, v] = project(label.position.toArray());
      label.visible = !taken.some(([x, y]) => Math.abs(x - u) < LABEL_WIDTH_PX && Math.abs(y - v) < LABEL_HEIGHT_PX);
      if (label.visible) taken.push([u, v]);
    }
  }
}
