// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// The picture of the mechanism: SVG in pixels of the screen, so that letters keep their size.
const SVG = "http://www.w3.org/2000/svg";
const LONGEST = 0.3;      // of the longest force, over the size of the mechanism
const INCH = 76;          // [px] for the signs of pivots and blocks
const AROUND = [0, -0.8, 0.8, -1.57, 1.57, -2.3, 2.3, Math.PI], FARTHER = [12, 24, 40, 62, 90];      // [rad] from the best on, [px]

const hundredths = value => (typeof value === "number" ? Math.round(100 * value) / 100 : value);
/** A group that is drawn again and again: its elements stay, and get the attributes that have changed. */
export class Sheet {
  constructor(group) { Object.assign(this, { group, count: 0 }); }
  /** The element that is next, if it is of this tag and has these attributes, else a new one there. */
  take(tag, attributes) {
    const next = this.group.children[this.count++], kind = [tag, ...Object.keys(attributes)].join();
    if (next?.kind === kind) return next;
    const element = Object.assign(document.createElementNS(SVG, tag), { kind });
    if (next) next.replaceWith(element);
    else this.group.append(element);
    return element;
  }
  /** Drop what was not drawn this time. */
  end() {
    while (this.group.children.length > this.count) this.group.lastChild.remove();
    this.count = 0;
  }
}
/** An element of SVG in a parent or on a sheet with attributes, points as pairs, and a text. */
export function draw(parent, tag, attributes = {}, text = "") {
  const element = parent.take?.(tag, attributes) ?? parent.appendChild(document.createElementNS(SVG, tag)), known = element.known ?? {};
  for (const name in attributes) {
    const value = name === "points" ? attributes[name].flat().map(hundredths).join(" ") : hundredths(attributes[name]);
    if (value !== known[name]) element.setAttribute(name, (known[name] = value));
  }
  element.known = known;
  if (text && element.textContent !== text) element.textContent = text;
  return element;
}
/** The head of an arrow along (c, s), so long, with its tip at a place [px]. */
const drawHead = (parent, attributes, [x, y], [c, s], length) =>
  draw(parent, "polygon", { ...attributes, points: [[x, y], [x - length * c - 5 * s, y - length * s + 5 * c], [x - length * c + 5 * s, y - length * s - 5 * c]] });
/** An arrow between places [px]. */
export function drawArrow(parent, attributes, [x1, y1], tip) {
  const [u, v] = [tip[0] - x1, tip[1] - y1], size = Math.hypot(u, v), c = u / size, s = v / size, back = Math.min(12, size);
  draw(parent, "line", { ...attributes, x1, y1, x2: tip[0] - back * c, y2: tip[1] - back * s });
  drawHead(parent, attributes, tip, [c, s], back);
}
/** The line through places [px], with gaps where they are NaN. */
export const lineThrough = places => places.map(([x, y], i) => (Number.isNaN(x + y) ? "" : `${i && !Number.isNaN(places[i - 1][0] + places[i - 1][1]) ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`)).join("");
const INDEX = /(?<!\w)([A-Za-z])_(?:\{([^{}]*)\}|([^\W_])(?!\w))/g;    // of labels.py
/** A text whose indices are lowered: F_{A1}, O_1; not tip_left. */
export function label(parent, attributes, words) {
  const text = draw(parent, "text", attributes);
  if (text.words === words) return text;
  text.words = words;
  text.replaceChildren();
  let end = 0;
  for (const { 0: { length }, 1: letter, 2: braced, 3: index = braced, index: start } of words.matchAll(INDEX)) {
    draw(text, "tspan", {}, words.slice(end, start) + letter);
    draw(text, "tspan", { dy: 4, "font-size": "80%" }, index);
    draw(text, "tspan", { dy: -4 }, "\u200b");
    end = start + length;
  }
  if (end < words.length) draw(text, "tspan", {}, words.slice(end));
  return text;
}
export const plain = words => words.replace(INDEX, "$1$2$3");
/** A value with four digits. */
export function significant(value) {
  if (Math.abs(value) === Infinity) return "unbounded";
  const rounded = Number(value.toPrecision(4)), size = Math.abs(rounded);
  return size !== 0 && (size < 1e-3 || size >= 1e7) ? rounded.toExponential() : String(rounded);
}
function hull(points) {
  const sorted = [...points].sort((p, q) => p[0] - q[0] || p[1] - q[1]), half = list => {
    const chain = [];
    for (const p of list) {
      while (chain.length > 1) {
        const [a, b] = chain.slice(-2);
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
        chain.pop();
      }
      chain.push(p);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}
/** Whether a segment meets a box [left, top, right, bottom]: no side of the box parts them, nor does the line. */
export function crosses([x1, y1, x2, y2], [left, top, right, bottom]) {
  if ((x1 < left && x2 < left) || (x1 > right && x2 > right) || (y1 < top && y2 < top) || (y1 > bottom && y2 > bottom)) return false;
  const side = (x, y) => (x2 - x1) * (y - y1) - (y2 - y1) * (x - x1);
  const a = side(left, top), b = side(right, top), c = side(left, bottom), d = side(right, bottom);
  return Math.min(a, b, c, d) <= 0 && Math.max(a, b, c, d) >= 0;
}

/** Where labels have room: inside, on no bar, no arrow, no pin, no ground and on no other label. */
class Room {
  /** lines: [x1, y1, x2, y2]; signs: boxes [left, top, right, bottom] that are taken [px]. */
  constructor(width, height, lines, signs) {
    Object.assign(this, { width, height, lines, boxes: signs });
  }
  /** The box for a text of this size at an anchor, `away` is the direction that looks best. */
  take([x, y], away, width, height) {
    let best = null, least = Infinity;
    for (const far of FARTHER) {
      for (const turn of AROUND) {
        const pure = far * 0.05 + Math.abs(turn) * 0.3, c = Math.cos(away + turn), s = Math.sin(away + turn);
        if (least <= pure) break;
        const u = x + c * (far + width / 2) - width / 2, v = y + s * (far + height / 2) - height / 2;
        const left = Math.min(Math.max(u, 2), this.width - width - 2), top = Math.min(Math.max(v, 2), this.height - height - 2);
        const box = [left, top, left + width, top + height];
        let cost = pure + 20 * (Math.abs(left - u) + Math.abs(top - v) > 1);
        for (const [l, t, r, b] of this.boxes) {
          const w = Math.min(r, box[2]) - Math.max(l, left), h = Math.min(b, box[3]) - Math.max(t, top);
          if (w > 0 && h > 0) cost += 60 + w * h;
        }
        for (const line of this.lines) if (cost < least && crosses(line, box)) cost += 40;
        if (cost < least) [best, least] = [box, cost];
      }
      if (least < 20) break;
    }
    this.boxes.push(best);
    return best;
  }
}

export class Picture {
  constructor(svg) {
    this.svg = svg;
    Object.assign(this, { view: { x: 0, y: 0, scale: 1, perNewton: 0 }, usual: 1 });
    [this.under, this.behind, this.main, this.grips, this.over] = ["under", "behind", "main", "grips", "over"].map(name => draw(svg, "g", { class: `fb ${name}` }));
    [this.paleSheet, this.sheet, this.gripSheet] = [this.behind, this.main, this.grips].map(group => new Sheet(group));
    this.measure();
  }
  measure() {
    const box = this.svg.getBoundingClientRect();
    [this.width, this.height] = [Math.max(box.width, 100), Math.max(box.height, 100)];
    this.svg.setAttribute("viewBox", `0 0 ${this.width} ${this.height}`);
  }
  get scale() { return this.view.scale; }
  /** Draw nothing; half a metre is as wide as the picture, its middle is the origin. */
  clear() {
    this.measure();
    for (const group of [this.under, this.behind, this.main, this.grips, this.over]) group.replaceChildren();
    this.usual = 2 * this.width;
    this.view = { scale: this.usual, x: -0.25, y: this.height / 4 / this.width, perNewton: 0 };
  }
  pixels([x, y]) { return [(x - this.view.x) * this.view.scale, (this.view.y - y) * this.view.scale]; }
  /** The place [px] of an event of a pointer in the picture. */
  at(event) {
    const box = this.svg.getBoundingClientRect();
    return [((event.clientX - box.left) * this.width) / box.width, ((event.clientY - box.top) * this.height) / box.height];
  }
  /** The place [m] of an event of a pointer. */
  metres(event) {
    const [x, y] = this.at(event);
    return [this.view.x + x / this.view.scale, this.view.y - y / this.view.scale];
  }
  /** Draw what is at (x, y) so many times as large and move it by (dx, dy) [px]; the picture keeps this view. */
  zoom(factor, [x, y], [dx, dy] = [0, 0]) {
    const { view, usual } = this, scale = Math.min(Math.max(view.scale * factor, usual / 50), usual * 1000);
    this.view = { ...view, scale, isChosen: true, x: view.x + x / view.scale - (x + dx) / scale, y: view.y - y / view.scale + (y + dy) / scale };
  }
  /** Choose the scales, so that all poses, places [m] and forces of the usual size have room, unless somebody chose a view; `isKept`: not while there is room. */
  fit(engine, isKept, places = []) {
    this.measure();
    const corners = [...engine.box, ...places], { size } = engine, margin = this.width < 600 ? 34 : 60;
    const [[left, right], [foot, top]] = [0, 1].map(i => [Math.min, Math.max].map(end => end(...corners.map(corner => corner[i]))));
    const { rows } = engine.sweep, sizes = Object.keys(engine.structure.sketch.forces).flatMap(name =>
      rows.map(row => row[engine.index[name]])).filter(Number.isFinite).sort((a, b) => a - b);
    const [most, usual] = [0.98, 0.5].map(part => sizes[Math.floor(part * (sizes.length - 1))] || 0), longest = Math.min(most, usual ? 5 * usual : most), reach = longest > 0 ? 0.15 * size : 0;
    this.usual = Math.min((this.width - 2 * margin) / (right - left + reach || size), (this.height - 2 * margin) / (top - foot + reach || size));
    if (!this.view.isChosen && !(isKept && this.shows(corners))) {
      this.view = { scale: this.usual, x: (left + right - this.width / this.usual) / 2, y: (foot + top + this.height / this.usual) / 2 };
    }
    this.view.perNewton = longest > 0 ? (LONGEST * size) / longest : 0;
  }
  /** Whether places [m] are inside. */
  shows(places) {
    return places.map(place => this.pixels(place)).every(([x, y]) => x > 0 && y > 0 && x < this.width && y < this.height);
  }
  /** Draw the links of an engine's pose on a sheet; joints in pixels, and the lines and signs that no label may cross. */
  links(engine, main) {
    const { sketch } = engine.structure, lines = [], signs = [], at = point => this.pixels(engine.point(point));
    const joints = Object.fromEntries(Object.entries(sketch.joints).map(([name, refs]) => [name, at(refs[0])]));
    for (const [x, y] of Object.values(joints)) signs.push([x - 7, y - 7, x + 7, y + 7]);
    for (const [x, y] of sketch.ground.map(name => joints[name])) {
      this.pivot(main, [x, y]);
      signs.push([x - 18, y, x + 18, y + 20]);
    }
    for (const plate of sketch.plates) {
      const corners = hull(plate.map(at));
      draw(main, "polygon", { class: "plate", points: corners });
      corners.forEach((p, i) => lines.push([...p, ...corners[(i + 1) % corners.length]]));
    }
    for (const bar of sketch.bars) {
      const [[x1, y1], [x2, y2]] = bar.map(at);
      lines.push([x1, y1, x2, y2]);
      for (const kind of ["bar", "core"]) draw(main, "line", { class: kind, x1, y1, x2, y2 });
    }
    for (const { joint, link, direction: [c, s], isGuided } of sketch.blocks) {
      const [, , cosine, sine] = engine.frame(link);
      this.block(main, joints[joint], [c * cosine - s * sine, -(c * sine + s * cosine)], isGuided, lines);
    }
    for (const { name, first, second } of sketch.springs) this.spring(main, at(first), at(second), name);
    return { joints, lines, signs };
  }
  /** Draw an engine's pose, in pale that of a second one; layers: {forces, curves, centres, values}. */
  draw(engine, layers, second) {
    if (second) this.links(second, this.paleSheet);
    this.paleSheet.end();
    const { sketch, input } = engine.structure, main = this.sheet, at = point => this.pixels(engine.point(point));
    const { joints, lines, signs } = this.links(engine, main), pins = Object.values(joints), labels = [];
    const segment = (kind, [x1, y1], [x2, y2]) => draw(main, "line", { class: kind, x1, y1, x2, y2 });
    for (const name in sketch.points) {
      const [link, along, across] = sketch.points[name], tip = at([link, along, across]);
      const start = at([link, 0, 0]), foot = at([link, along, 0]);
      for (const [p, q] of [[start, foot], [foot, tip]]) segment("arm", p, q);
      draw(main, "circle", { class: "point", cx: tip[0], cy: tip[1], r: 5 });
      labels.push({ kind: "point", anchor: tip, away: -0.8, words: name });
    }
    for (const [x, y] of pins) draw(main, "circle", { class: "pin", cx: x, cy: y, r: 5.5 });
    if (layers.forces !== false && engine.status === 0) {
      for (const { name, words, point, vector } of this.forces(engine)) {
        const tip = this.arrow(main, name.startsWith("external.") ? "applied" : "force", this.pixels(point), vector, lines);
        if (tip) labels.push({ kind: "force", anchor: tip, start: this.pixels(point), away: Math.atan2(-vector[1], vector[0]), words, extra: true, name });
      }
      const torque = engine.get(engine.structure.drive);
      if (engine.isAngle && Math.abs(torque) * this.view.perNewton > 1e-10 * engine.size ** 2) {      // more than rounding
        const [x, y] = joints[Object.keys(joints)[0]], sense = torque > 0 ? 1 : -1;
        this.turn(main, x, y, sense);
        signs.push([x - 24, y - 24, x + 24, y + 24]);
        labels.push({ kind: "drive", anchor: [x - 24, y - 18], away: -2.3, words: `T = ${significant(torque)} N m`, extra: true, name: "drive" });
      }
    }
    if (layers.centres) this.centres(main, engine, labels);
    const letters = Object.entries(sketch.letters).filter(([name], i, all) => all.findIndex(([, letter]) => letter === all[i][1]) === i && joints[name]);
    const middle = pins.reduce((sum, p) => [sum[0] + p[0] / pins.length, sum[1] + p[1] / pins.length], [0, 0]);
    labels.unshift(...letters.map(([name, letter]) => ({ kind: "letter", anchor: joints[name], words: letter,
      away: Math.atan2(joints[name][1] - middle[1], joints[name][0] - middle[0]) })));
    const room = this.room = new Room(this.width, this.height, lines, signs), isNarrow = this.width < 600;
    for (const one of labels) {
      if (one.extra && (layers.values === false || (isNarrow && one.name !== this.chosen))) continue;
      if ((one.start ?? one.anchor).some((value, i) => value < 0 || value > [this.width, this.height][i])) continue;
      const width = 8.4 * plain(one.words).length + 4, box = room.take(one.anchor, one.away, width, 18);
      const [x, y] = one.anchor, [u, v] = [Math.min(Math.max(x, box[0]), box[2]), Math.min(Math.max(y, box[1]), box[3])];
      if (Math.hypot(u - x, v - y) > 34) segment("leader", [x, y], [u, v]);
      label(main, { class: one.kind, x: box[0] + 2, y: box[3] - 4 }, one.words);
    }
    main.end();
    this.grip(joints, sketch);
    this.svg.setAttribute("aria-label", `the mechanism at ${input.name} = ${significant(engine.isAngle ? (engine.x * 180) / Math.PI : engine.x)} ${engine.isAngle ? "degrees" : "m"}`);
  }
  drawTraces(engine, layers) {
    const paths = (layers.curves === false ? [] : Object.values(engine.structure.sketch.points)).map(point => engine.path(point));
    this.under.replaceChildren();
    for (const path of paths) draw(this.under, "path", { class: "trace", d: lineThrough(path.map(place => this.pixels(place))) });
  }
  /** Forces that are drawn: reactions by their letters, external ones, as {name, words, point [m], vector [px]}. */
  forces(engine) {
    const { sketch } = engine.structure, long = this.view.perNewton * this.view.scale, list = [];
    for (const name in sketch.forces) {
      const [x, y] = [engine.get(`${name}_x`), engine.get(`${name}_y`)];
      list.push({ name, words: `${sketch.symbols[name]} = ${significant(Math.hypot(x, y))} N`, point: engine.joint(sketch.forces[name]), vector: [x * long, y * long] });
    }
    for (const { name, point } of sketch.applied) {
      const [x, y] = ["force_x", "force_y"].map(field => engine.number(`${name}.${field}`));
      if (x || y) list.push({ name, words: `${significant(Math.hypot(x, y))} N`, point: engine.point(point), vector: [x * long, y * long] });
    }
    return list;
  }
  pivot(parent, [x, y]) {
    const w = 0.12 * INCH, h = 0.19 * INCH, ground = [x - 2 * w, y + h, x + 2 * w, y + h];
    draw(parent, "polygon", { class: "ground", points: [[x, y], [x - w, y + h], [x + w, y + h]] });
    draw(parent, "line", { class: "ground", x1: ground[0], y1: ground[1], x2: ground[2], y2: ground[3] });
    for (let i = -2; i < 2; i++) draw(parent, "line", { class: "hatch", x1: x + i * w, y1: y + h + 6, x2: x + i * w + 6, y2: y + h });
  }
  block(parent, [x, y], [c, s], isGuided, lines) {
    const at = (u, v) => [x + u * c - v * s, y + u * s + v * c], a = 0.2 * INCH, b = 0.11 * INCH;
    for (const v of [-b, b]) {
      const [[x1, y1], [x2, y2]] = [-1, 1].map(end => at((isGuided ? 3.5 : 1) * a * end, v));
      if (isGuided) draw(parent, "line", { class: "ground", x1, y1, x2, y2 });
      lines.push([x1, y1, x2, y2]);
    }
    draw(parent, "polygon", { class: "block", points: [at(a, b), at(a, -b), at(-a, -b), at(-a, b)] });
  }
  spring(parent, [x1, y1], [x2, y2], name) {
    const length = Math.hypot(x2 - x1, y2 - y1) || 1, c = (x2 - x1) / length, s = (y2 - y1) / length, coils = 14, w = 7;
    const at = (part, side) => [x1 + part * (x2 - x1) - side * w * s, y1 + part * (y2 - y1) + side * w * c];
    const places = [[x1, y1], at(0.15, 0)];
    for (let i = 0; i < coils; i++) places.push(at(0.15 + (0.7 * (i + 0.5)) / coils, i % 2 ? 1 : -1));
    draw(parent, "polyline", { class: "spring", points: [...places, at(0.85, 0), [x2, y2]], "data-spring": name });
    for (const [cx, cy] of [[x1, y1], [x2, y2]]) draw(parent, "circle", { class: "end", cx, cy, r: 3.5 });
  }
  /** An arrow of a vector [px, y upwards]; its tip, the point of one that is too short to be seen, null of none and of one too long. */
  arrow(parent, kind, [x, y], [u, v], lines) {
    const size = Math.hypot(u, v);
    if (!(size > 1e-6 && size < 20 * this.width)) return null;
    if (size < 5) return [x, y];
    const tip = [x + u, y - v];
    drawArrow(parent, { class: kind }, [x, y], tip);
    lines.push([x, y, ...tip]);
    return tip;
  }
  turn(parent, x, y, sense) {
    const r = 22, [a, b] = sense > 0 ? [2.6, 5.6] : [3.7, 0.7], at = angle => [x + r * Math.cos(angle), y - r * Math.sin(angle)];
    const [start, end] = [at(a), at(b)], tangent = [-Math.sin(b) * sense, -Math.cos(b) * sense];
    draw(parent, "path", { class: "drive", d: `M${start} A${r} ${r} 0 0 ${sense > 0 ? 0 : 1} ${end}` });
    drawHead(parent, { class: "drive" }, [end[0] + 9 * tangent[0], end[1] + 9 * tangent[1]], tangent, 9);
  }
  /** A cross and P_ij at each instant centre of two links in view; link 1 is the ground. Of four links the axis of collineation, through P_13 and P_24. */
  centres(parent, engine, labels) {
    const links = engine.structure.links.map(link => {
      const i = engine.index[`frame.${link}.x`], to = engine.to, w = to[i + 8];
      return [w, to[i + 2] + w * to[i + 1], to[i + 3] - w * to[i]];     // velocity at the origin, if the link were there
    });
    const every = [[0, 0, 0], ...links], centreOf = (p, q) => {
      const w = q[0] - p[0];
      return this.pixels([-(q[2] - p[2]) / w, (q[1] - p[1]) / w]);
    };
    if (every.length === 4) {
      const [[x1, y1], [x2, y2]] = [centreOf(every[0], every[2]), centreOf(every[1], every[3])], size = Math.hypot(x2 - x1, y2 - y1);
      const [u, v] = [x2 - x1, y2 - y1].map(part => (2 * (this.width + this.height) * part) / size), s = ((this.width / 2 - x1) * u + (this.height / 2 - y1) * v) / (u * u + v * v);
      if (Number.isFinite(s) && size > 1e-6) draw(parent, "line", { class: "axis", x1: x1 + (s - 1) * u, y1: y1 + (s - 1) * v, x2: x1 + (s + 1) * u, y2: y1 + (s + 1) * v });
    }
    every.forEach((p, i) => every.slice(i + 1).forEach((q, j) => {
      const [x, y] = centreOf(p, q);
      if (!(x > 0 && y > 0 && x < this.width && y < this.height)) return;
      for (const k of [-6, 6]) draw(parent, "line", { class: "centre", x1: x - 6, y1: y - k, x2: x + 6, y2: y + k });
      labels.push({ kind: "centre", anchor: [x, y], away: 0.8, words: `P_{${i + 1}${i + j + 2}}` });
    }));
  }
  /** Grips stay the same elements while the pose moves, so that they keep the focus. */
  grip(joints, { ground, letters }) {
    for (const [name, [cx, cy]] of Object.entries(joints).filter(([joint]) => !ground.includes(joint))) {
      draw(this.gripSheet, "circle", { class: "grip", r: 22, tabindex: 0, role: "slider", "aria-label": `joint ${plain(letters[name] ?? name)}`, "aria-valuenow": 0, "data-joint": name, cx, cy });
    }
    this.gripSheet.end();
  }
  /** The picture as a file, in the colours of print. */
  file(style) {
    const copy = this.svg.cloneNode(true);
    for (const gone of copy.querySelectorAll(".grips, .over, .cross")) gone.remove();
    copy.setAttribute("xmlns", SVG);
    copy.setAttribute("width", this.width);
    copy.setAttribute("height", this.height);
    const rules = document.createElementNS(SVG, "style"), paper = document.createElementNS(SVG, "rect");
    rules.textContent = style.replace(/var\([\w-]+, ?([^)]*)\)/g, "$1");
    for (const [name, value] of Object.entries({ width: "100%", height: "100%", fill: "#fff" })) paper.setAttribute(name, value);
    copy.prepend(rules, paper);
    return new XMLSerializer().serializeToString(copy);
  }
}
