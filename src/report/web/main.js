// What is done to the report once its text is on the screen: charts, then the 3-D view.
import { drawCharts } from './charts.js';
import { openView } from './view.js';

function start() {
  const data = JSON.parse(document.getElementById('report-data').textContent);
  drawCharts(data.charts ?? []);
  if (data.points || data.poses) openView(data);
}

// After the first screen has been painted.
requestAnimationFrame(() => setTimeout(start, 0));
