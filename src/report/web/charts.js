// Curves over the distance driven or the frames, drawn with uPlot in the colours of the page.
import uPlot from 'uplot';
import uPlotCss from 'uplot/dist/uPlot.min.css';

const HEIGHT_PX = 220;

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function axis(label) {
  return {
    label,
    labelSize: 22,
    labelFont: '12px system-ui, sans-serif',
    font: '11px system-ui, sans-serif',
    stroke: colour('--soft'),
    grid: { stroke: colour('--line'), width: 1 },
    ticks: { stroke: colour('--line'), width: 1 },
  };
}

function seriesOf(series, index) {
  const stroke = colour(`--curve-${(index % 4) + 1}`);
  return {
    label: series.label,
    stroke,
    width: series.points ? 0 : 1.75,
    points: { show: Boolean(series.points), size: 5, fill: stroke },
    spanGaps: false,
    value: (_, value) => (value == null ? '' : Number(value.toPrecision(4)).toString()),
  };
}

function draw(chart, place) {
  place.replaceChildren();
  const options = {
    width: place.clientWidth,
    height: HEIGHT_PX,
    cursor: { drag: { x: true, y: false } },
    scales: { x: { time: false } },
    axes: [axis(chart.x.label), { ...axis(chart.yLabel), size: 58 }],
    series: [
      { label: chart.x.label, value: (_, value) => (value == null ? '' : value.toFixed(2)) },
      ...chart.series.map(seriesOf),
    ],
  };
  return new uPlot(options, [chart.x.values, ...chart.series.map((one) => one.values)], place);
}

// Into each element with data-chart, anew where the colours change, as wide as the page leaves it.
export function drawCharts(charts) {
  const style = document.createElement('style');
  style.textContent = uPlotCss;
  document.head.append(style);
  const drawn = [];
  for (const chart of charts) {
    const place = document.querySelector(`[data-chart="${chart.id}"]`);
    if (place) drawn.push({ chart, place, plot: draw(chart, place) });
  }
  const redraw = () => {
    for (const one of drawn) {
      one.plot.destroy();
      one.plot = draw(one.chart, one.place);
    }
  };
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
  document.addEventListener('rigmap-theme', redraw);
  const fit = () => {
    for (const { plot, place } of drawn) {
      if (place.clientWidth > 0) plot.setSize({ width: place.clientWidth, height: HEIGHT_PX });
    }
  };
  addEventListener('resize', fit);
  addEventListener('beforeprint', fit);
}
