// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// Count the labels of a page, over 24 poses, that a line crosses or another one covers, and those outside.
const crosses = ([x1, y1, x2, y2], [left, top, right, bottom]) => {
  let low = 0, high = 1;
  for (const [p, d, a, b] of [[x1, x2 - x1, left, right], [y1, y2 - y1, top, bottom]]) {
    if (d === 0) { if (p < a || p > b) return false; continue; }
    const [u, v] = [(a - p) / d, (b - p) / d].sort((m, n) => m - n);
    low = Math.max(low, u); high = Math.min(high, v);
  }
  return low <= high;
};
const svg = document.getElementById('picture'), [low, high] = [page.engine.ranges[0][0], page.engine.ranges.at(-1)[1]];
const found = { labels: 0, crossed: 0, covered: 0, outside: 0 };
for (let i = 0; i < 24; i++) {
  page.store.dispatch({ view: { at: page.engine.inside(low + (high - low) * i / 24) } });
  const bars = [...svg.querySelectorAll('.bar, line.force')].map(e => ['x1', 'y1', 'x2', 'y2'].map(n => Number(e.getAttribute(n))));
  const boxes = [...svg.querySelectorAll('.main text')].map(e => { const b = e.getBBox(); return [b.x + 1, b.y + 3, b.x + b.width - 1, b.y + b.height - 3]; });
  boxes.forEach((box, k) => {
    found.labels++;
    if (bars.some(bar => crosses(bar, box))) found.crossed++;
    if (boxes.some((b, j) => j > k && b[0] < box[2] && box[0] < b[2] && b[1] < box[3] && box[1] < b[3])) found.covered++;
    if (box[0] < 0 || box[1] < -2 || box[2] > page.picture.width || box[3] > page.picture.height) found.outside++;
  });
}
return found;
