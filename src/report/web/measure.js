// How far apart two points of the map are, and how well that is known.
import { sigmaOf } from './points.js';

function nearestPose(poses, point) {
  let best = 0, least = Infinity;
  for (let i = 0; i < poses.x.length; ++i) {
    const d = Math.hypot(poses.x[i] - point.x, poses.y[i] - point.y, poses.z[i] - point.z);
    if (d < least) [best, least] = [i, d];
  }
  return { index: best, distance: least };
}

const square = (x) => x * x;

// What the poses between two cameras leave unknown along a direction beside the scale, m^2: sigmas
// in the file are relative to the first pose and errors add up along the way, so that it is the sum
// of the changes, and never more than both cameras' own. The scale's share of a sigma grows with
// the distance from the first pose, and would be taken for an error that adds up.
function variance(poses, a, b, direction, scaleSigma) {
  const at = (i) => {
    const whole = square(poses.sx[i] * direction.x) + square(poses.sy[i] * direction.y) +
      square(poses.sz[i] * direction.z);
    const way = (poses.x[i] - poses.x[0]) * direction.x + (poses.y[i] - poses.y[0]) * direction.y +
      (poses.z[i] - poses.z[0]) * direction.z;
    return Math.max(0, whole - square(scaleSigma * way));
  };
  let changes = 0;
  for (let i = Math.min(a, b); i < Math.max(a, b); ++i) changes += Math.abs(at(i + 1) - at(i));
  return Math.min(changes, at(a) + at(b));
}

// distance_m and sigma_m (one standard deviation; NaN where nothing is known of the points).
// Both points' noise, the relative position and rotation of the cameras nearest to them, and the
// scale of the whole: all of what is known of it, and what of that is in the poses' sigmas.
export function measure(one, other, poses, scale = { sigma: 0, inPoses: 0 }) {
  const between = other.position.clone().sub(one.position);
  const distance_m = between.length();
  const direction = distance_m > 0 ? between.clone().divideScalar(distance_m) : between;
  let sum = square(sigmaOf(one.sigma)) + square(sigmaOf(other.sigma));
  if (poses) {
    const a = nearestPose(poses, one.position), b = nearestPose(poses, other.position);
    sum += variance(poses, a.index, b.index, direction, scale.inPoses);
    const turned = Math.abs(square(poses.sr[a.index]) - square(poses.sr[b.index]));
    sum += turned * square(Math.max(a.distance, b.distance));
  }
  sum += square(scale.sigma * distance_m);
  return { distance_m, sigma_m: Math.sqrt(sum) };
}

// One standard deviation with two digits: 4.1 mm, 2.6 cm, 1.3 m.
export function sigmaText(sigma_m) {
  if (sigma_m < 0.01) return `${(1000 * sigma_m).toPrecision(2)} mm`;
  return sigma_m < 0.995 ? `${(100 * sigma_m).toPrecision(2)} cm` : `${sigma_m.toFixed(sigma_m < 10 ? 1 : 0)} m`;
}

// "2.413 m ± 4.1 mm (one sigma)": the sigma decides how many digits are worth showing.
export function lengthText({ distance_m, sigma_m }) {
  if (!Number.isFinite(sigma_m)) return `${distance_m.toFixed(3)} m`;
  const digits = sigma_m < 0.001 ? 4 : sigma_m < 0.1 ? 3 : 2;
  return `${distance_m.toFixed(digits)} m ± ${sigmaText(sigma_m)} (one sigma)`;
}
