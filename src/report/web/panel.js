// Buttons, layers, legend and what is said of what was clicked, around the 3-D view.
import { sigmaText } from './measure.js';
import { observationsOf, sigmaOf } from './points.js';

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

// Between which codes or heights the colours run, and what stands at either end of the legend.
function colourRanges(view) {
  const { points } = view.data;
  const [low, high] = points.height_range_m;
  const z = points.origin[2];
  const sigma = points.sigma_range, seen = points.observations_range;
  const text = (code) => sigmaText(sigmaOf(code));
  return {
    1: { range: [low - z, high - z], ends: [`${low.toFixed(2)} m`, `${high.toFixed(2)} m`], name: 'Height (world z)' },
    2: { range: sigma, ends: sigma.map(text), name: 'Sigma of a point off its surface' },
    3: { range: seen, ends: seen.map((code) => String(observationsOf(code))), name: 'Depth pixels merged into a point' },
  };
}

function colourChoice(view, legend) {
  const select = element('select', { ariaLabel: 'Colour of the points' });
  ['Colour of the images', 'Height', 'Sigma', 'Observations'].forEach((name, mode) => {
    select.append(element('option', { value: String(mode), textContent: name }));
  });
  select.addEventListener('change', () => {
    const mode = Number(select.value);
    const { uniforms } = view.cloud.material;
    uniforms.mode.value = mode;
    legend.hidden = mode === 0;
    if (mode > 0) {
      const { range, ends, name } = colourRanges(view)[mode];
      uniforms.range.value.set(...range);
      legend.replaceChildren(element('span', { textContent: name }), element('span', { textContent: ends[0] }),
        element('i'), element('span', { textContent: ends[1] }));
    }
    view.paint();
  });
  return element('label', {}, 'Points ', select);
}

function sizeSlider(view) {
  const slider = element('input', { type: 'range', min: '-2', max: '2', step: '0.1', value: '0', ariaLabel: 'Size of the points' });
  slider.addEventListener('input', () => {
    view.cloud.material.uniforms.size.value = 2 ** Number(slider.value);
    view.paint();
  });
  return element('label', {}, 'Size ', slider);
}

function layerBoxes(view) {
  const boxes = element('div', { className: 'layers' });
  for (const layer of Object.values(view.layers)) {
    const box = element('input', { type: 'checkbox', checked: layer.object.visible });
    box.dataset.layer = layer.id;
    box.addEventListener('change', () => {
      layer.object.visible = box.checked;
      view.paint();
    });
    const label = element('label', {}, box);
    if (layer.colour !== null) {
      const swatch = element('i', { className: 'swatch' });
      swatch.style.background = `#${layer.colour.toString(16).padStart(6, '0')}`;
      label.append(swatch);
    }
    label.append(layer.name);
    boxes.append(label);
  }
  return boxes;
}

export function makePanel(section, view) {
  const button = (text, title, act) => {
    const made = element('button', { type: 'button', textContent: text, title });
    made.addEventListener('click', act);
    return made;
  };
  const legend = element('div', { className: 'legend', hidden: true });
  const fly = button('Fly along', 'Along the path (f)', () => view.fly());
  const views = element('div', { className: 'buttons' },
    button('Overview', 'From aside (o)', () => view.seeFrom('oblique')),
    button('From above', 'From above (t)', () => view.seeFrom('top')));
  if (view.world.poses) views.append(button('On the path', 'From the first camera (p)', () => view.seeFrom('path')), fly);
  views.append(button('Full screen', 'Full screen', () => {
    if (document.fullscreenElement) document.exitFullscreen();
    else section.querySelector('.viewer').requestFullscreen?.();
  }));
  const bar = section.querySelector('.bar');
  bar.append(views);
  if (view.cloud) bar.append(colourChoice(view, legend), sizeSlider(view));
  bar.append(layerBoxes(view));

  const stage = section.querySelector('.stage');
  const said = element('output', { className: 'said' });
  const count = element('span', { className: 'count' });
  const card = element('figure', { className: 'card', hidden: true });
  stage.append(legend, said, count, card);

  return {
    say(text) {
      said.textContent = text;
    },
    loaded(points, header) {
      const all = header.count_in_map;
      count.textContent = `${points.toLocaleString('en')} of ${all.toLocaleString('en')} points`;
    },
    flying(on) {
      fly.textContent = on ? 'Stop' : 'Fly along';
    },
    showCamera(index) {
      const { poses } = view.data;
      const thumbnail = document.querySelector(`img[data-frame="${index}"]`);
      const sigma = Math.max(...[poses.sx, poses.sy, poses.sz].map((of) => of[index] ?? NaN));
      const known = Number.isFinite(sigma) ? `sigma up to ${sigmaText(sigma)}` : 'sigma unknown';
      const close = element('button', { type: 'button', textContent: '\u00d7', ariaLabel: 'Close' });
      close.addEventListener('click', () => { card.hidden = true; });
      card.replaceChildren(close);
      if (thumbnail) card.append(element('img', { src: thumbnail.src, alt: thumbnail.alt }));
      card.append(element('figcaption', {
        textContent: `Frame ${index}, ${poses.t[index].toFixed(1)} s, ${poses.source[index]}, ` +
          `${known}${thumbnail ? '' : ' (this page holds no image of it)'}`,
      }));
      card.hidden = false;
    },
  };
}
