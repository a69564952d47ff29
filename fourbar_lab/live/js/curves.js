// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// Curves over the input with their extrema, and the polygons of velocities and accelerations.
import { TURN } from "./engine.js";
import { draw, drawArrow, label, lineThrough, plain, significant } from "./picture.js";
const HEIGHT = 150, LEFT = 62, RIGHT = 14, TOP = 26, BOTTOM = 22;      // [px] of one curve
const DASHES = ["", "7 3", "2 3", "9 3 2 3", "12 4", "4 2"];

/** A step of 1, 2 or 5 times a power of ten, for at most `count` ticks. */
function stepOf(span, count) {
  const power = 10 ** Math.floor(Math.log10(span / count));
  return power * [1, 2, 5, 10].find(part => (power * part * count) / span >= 1);
}
/** A unit and a factor for people: degrees for angles, else as it is. */
export function shownUnit(unit) {
  return unit === "rad" ? ["deg", 360 / TURN] : [unit.replace("^2", "²"), 1];
}

/** What people call a quantity: the symbol of a force as in the picture, else its words. */
export const shownName = (structure, name) => structure.quantities[name]?.symbol?.replace(/[{}]/g, "") ?? name.replaceAll("_", " ");

export class Curves {
  /** holder: a <div>; go(input) is called where somebody clicks or drags in a curve. */
  constructor(holder, go) {
    Object.assign(this, { holder, go, charts: [], extrema: [] });
  }
  /** Draw the curves of an engine with extrema that were found of them, in pale those of a second one. */
  draw(engine, names, everyExtremum, second) {
    const { input, quantities } = engine.structure, width = Math.max(this.holder.clientWidth, 240);
    const [, factor] = shownUnit(input.unit), right = width - RIGHT, bottom = HEIGHT - BOTTOM;
    [this.charts, this.extrema] = [[], everyExtremum];
    this.holder.replaceChildren();
    if (!engine.ranges.length) return;
    const low = engine.ranges[0][0] * factor, high = engine.ranges.at(-1)[1] * factor;
    const across = x => LEFT + ((x * factor - low) / (high - low)) * (right - LEFT);
    names.forEach((name, index) => {
      const [unit, scale] = shownUnit(quantities[name].unit), values = engine.curve(name), extrema = everyExtremum.filter(one => one.quantity === name);
      const shown = values.map(value => value * scale), shownToo = second?.structure.quantities[name] ? second.curve(name).map(value => value * scale) : [];
      const finite = [...shown, ...shownToo].filter(Number.isFinite).sort((a, b) => a - b);
      const svg = draw(this.holder, "svg", { class: "curve", viewBox: `0 0 ${width} ${HEIGHT}`, height: HEIGHT, role: "img", "aria-label": `${shownName(engine.structure, name)} over ${input.name}, ${extrema.map(one => `${one.kind} ${significant(one.value * scale)}`).join(", ")} ${unit}` });
      draw(draw(svg, "text", { class: "name", x: 8, y: 16 }, `${shownName(engine.structure, name)} [${unit || "-"}]`), "title", {}, name);
      if (!finite.length) return;
      // what runs away at a toggle leaves the rest its room
      let [least, most] = [finite[0], finite.at(-1)];
      const [a, b] = [0.02, 0.98].map(part => finite[Math.round(part * (finite.length - 1))]);
      if (most - least > 20 * (b - a) && b > a) [least, most] = [a - 0.5 * (b - a), b + 0.5 * (b - a)];
      const noise = engine.noise(name, values) * scale, largest = Math.max(Math.abs(least), Math.abs(most)), room = most - least > noise ? 0.06 * (most - least) : largest > noise ? 0.1 * largest : 1;
      [least, most] = [least - room, most + room];
      const up = value => bottom - ((value - least) / (most - least)) * (bottom - TOP);
      if (name.startsWith("transmission_angle") && unit === "deg") {
        const [top, foot] = [140, 40].map(value => Math.min(Math.max(up(value), TOP), bottom));
        draw(svg, "rect", { class: "good", x: LEFT, y: top, width: right - LEFT, height: Math.max(foot - top, 0) });
      }
      const step = stepOf(most - least, 6);
      for (let tick = Math.ceil(least / step) * step; tick <= most; tick += step) {
        draw(svg, "line", { class: "grid", x1: LEFT, y1: up(tick), x2: right, y2: up(tick) });
        draw(svg, "text", { class: "tick", x: LEFT - 6, y: up(tick) + 4, "text-anchor": "end" }, significant(Math.abs(tick) < step / 1e6 ? 0 : tick));
      }
      const along = engine.isAngle ? [15, 30, 45, 90].find(part => (high - low) / part <= Math.max(4, width / 90)) ?? 180 : stepOf(high - low, 5);
      for (let tick = Math.ceil(low / along - 1e-9) * along; tick <= high + 1e-9 * along; tick += along) {
        const x = across(tick / factor);
        draw(svg, "line", { class: "grid", x1: x, y1: TOP, x2: x, y2: bottom });
        draw(svg, "text", { class: "tick", x, y: HEIGHT - 6, "text-anchor": "middle" }, significant(Math.abs(tick) < along / 1e6 ? 0 : tick));
      }
      const isShown = value => value >= least - 4 * (most - least) && value <= most + 4 * (most - least);
      const isJump = (i, inputs) => inputs[i] - inputs[i - 1] > (0.1 * (high - low)) / factor;
      const pathOf = (inputs, values) => lineThrough(values.flatMap((value, i) => {
        const place = isShown(value) ? [across(inputs[i]), Math.min(Math.max(up(value), 0), HEIGHT)] : [NaN, NaN];
        return isJump(i, inputs) ? [[NaN, NaN], place] : [place];
      }));
      if (shownToo.length) draw(svg, "path", { class: "line pale", d: pathOf(second.sweep.inputs, shownToo) });
      draw(svg, "path", { class: `line c${index % 6}`, d: pathOf(engine.sweep.inputs, shown), "stroke-dasharray": DASHES[index % 6] });
      const taken = [];
      for (const { x, value, kind, isGlobal } of extrema.flatMap(one => one.inputs.map(x => ({ ...one, x })))) {
        const [u, v] = [across(x), up(value * scale)];
        if (v < TOP - 4 || v > bottom + 4) continue;
        draw(svg, "circle", { class: `mark c${index % 6}`, cx: u, cy: v, r: isGlobal ? 4 : 2.5 });
        if (!isGlobal || taken.some(place => Math.abs(place - u) < 60)) continue;
        taken.push(u);
        draw(svg, "text", { class: "value", x: Math.min(Math.max(u, LEFT + 26), right - 26), y: kind === "maximum" ? (v < TOP + 16 && u < LEFT + 170 ? v + 16 : Math.max(v - 6, 12)) : v + 15 > bottom ? v - 8 : v + 15, "text-anchor": "middle" }, significant(value * scale));
      }
      const cursor = draw(svg, "line", { class: "cursor", y1: TOP, y2: bottom });
      this.charts.push({ svg, cursor, across, back: u => (low + ((u - LEFT) / (right - LEFT)) * (high - low)) / factor });
      svg.onpointerdown = svg.onpointermove = event => {
        if (!event.buttons) return;
        const box = svg.getBoundingClientRect();
        this.go(engine.inside(Math.min(Math.max(this.charts[0].back(((event.clientX - box.left) * width) / box.width), low / factor), high / factor)));
      };
    });
  }
  /** Move the cursors to an input. */
  follow(engine, x) {
    const here = engine.counted(x);
    for (const { cursor, across } of this.charts) {
      cursor.setAttribute("x1", across(here));
      cursor.setAttribute("x2", across(here));
    }
  }
}

/** Draw the velocity polygon (order 0) or that of accelerations (1) of a pose: from the pole o, link by link. */
export function drawPolygon(svg, engine, order) {
  const width = svg.clientWidth || 320, height = 260, { sketch, links } = engine.structure, shown = [], sides = [];
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.replaceChildren();
  const rateOf = point => engine.rates(point).slice(2 * order, 2 * order + 2), letter = name => plain(sketch.letters[name] ?? name);
  for (const [name, refs] of Object.entries(sketch.joints)) {
    const tip = rateOf(refs[0]);
    if (Math.hypot(...tip) > 0 && !shown.some(one => one.letter === letter(name))) shown.push({ letter: letter(name), tip });
  }
  for (const link of links) {
    const on = Object.entries(sketch.joints).flatMap(([name, refs]) => refs.filter(ref => ref[0] === link).map(ref => [letter(name), rateOf(ref)]));
    for (const [name, tip] of on.slice(1)) if (Math.hypot(...on[0][1]) > 0) sides.push({ from: on[0], to: [name, tip] });
  }
  const every = [[0, 0], ...shown.map(one => one.tip)].filter(tip => tip.every(Number.isFinite));
  const [left, low, right, top] = [Math.min(...every.map(t => t[0])), Math.min(...every.map(t => t[1])), Math.max(...every.map(t => t[0])), Math.max(...every.map(t => t[1]))];
  const scale = Math.min((width - 120) / (right - left || 1), (height - 70) / (top - low || 1));
  const at = ([x, y]) => [width / 2 + (x - (left + right) / 2) * scale, height / 2 - (y - (low + top) / 2) * scale];
  const arrow = (kind, p, q, words) => {
    const [a, b] = [at(p), at(q)], size = Math.hypot(b[0] - a[0], b[1] - a[1]);
    if (!(size > 3)) return;
    drawArrow(svg, { class: kind }, a, b);
    label(svg, { class: kind, x: (a[0] + b[0]) / 2 + (8 * (b[1] - a[1])) / size + 4, y: (a[1] + b[1]) / 2 - (8 * (b[0] - a[0])) / size }, words);
  };
  const symbol = order ? "a" : "v", unit = order ? "m/s²" : "m/s";
  for (const { from, to } of sides) arrow("part", from[1], to[1], `${symbol}_{${to[0]}/${from[0]}}`);
  for (const { letter: name, tip } of shown) arrow("sum", [0, 0], tip, `${symbol}_{${name}} = ${significant(Math.hypot(...tip))} ${unit}`);
  const [x, y] = at([0, 0]);
  draw(svg, "circle", { class: "pin", cx: x, cy: y, r: 4 });
  draw(svg, "text", { x: x - 14, y: y + 14 }, "o");
}
