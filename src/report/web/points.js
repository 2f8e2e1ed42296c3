// The map's points as report/point_planes.cc packs them: byte planes, deflated, in base64.

function fromBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Metres from the steps of one axis: four planes of zigzagged differences.
function unpackAxis(planes, first, count, origin, step, into, offset) {
  let steps = 0;
  for (let i = 0; i < count; ++i) {
    const coded = (planes[first + i] | (planes[first + count + i] << 8) |
      (planes[first + 2 * count + i] << 16) | (planes[first + 3 * count + i] << 24)) >>> 0;
    steps += (coded >>> 1) ^ -(coded & 1);
    into[3 * i + offset] = origin + steps * step;
  }
}

function unpackColours(planes, first, count) {
  const rgb = new Uint8Array(3 * count);
  let green = 0, red = 0, blue = 0;
  for (let i = 0; i < count; ++i) {
    green = (green + planes[first + i]) & 255;
    red = (red + planes[first + count + i]) & 255;
    blue = (blue + planes[first + 2 * count + i]) & 255;
    rgb[3 * i] = (red + green) & 255;
    rgb[3 * i + 1] = green;
    rgb[3 * i + 2] = (blue + green) & 255;
  }
  return rgb;
}

// One level of the map. Positions are relative to `header.origin` in double precision steps, so that
// maps of kilometres keep their millimetres.
export async function unpackLevel(level, header) {
  const element = document.getElementById(level.id);
  if (!element) return null;
  const planes = await inflate(fromBase64(element.textContent.trim()));
  element.remove();  // its text would stay in memory
  const n = level.count;
  const positions = new Float32Array(3 * n);
  for (let axis = 0; axis < 3; ++axis) {
    unpackAxis(planes, 4 * n * axis, n, 0, header.step_m, positions, axis);
  }
  return {
    count: n,
    positions,
    colours: unpackColours(planes, 12 * n, n),
    sigmas: planes.slice(15 * n, 16 * n),
    observations: planes.slice(16 * n, 17 * n),
    grains: planes.slice(17 * n, 18 * n),
  };
}

// Metres, as report/point_planes.h codes them; 0 is unknown.
export const sigmaOf = (code) => (code === 0 ? NaN : 1e-5 * 2 ** ((code - 1) / 12));
export const observationsOf = (code) => Math.round(2 ** (code / 16));
export const grainOf = (code, finest) => finest * 2 ** (code / 4);
