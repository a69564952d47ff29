// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// A structure's module with the numbers of a scene: poses, ranges, samples. No document here.
export const TURN = 2 * Math.PI;
const SAMPLES = 361;      // of a range
const SAME = 1e-11;       // of their size: samples that differ by less are those of a constant
const STEEP = 0.2;        // of an extreme sample, and of its way from the median: where a neighbour differs by more, none tells how large it is
const sameTurn = (angle, reference) => angle + TURN * Math.round((reference - angle) / TURN || 0);
const median = values => {
  const known = values.filter(Number.isFinite).sort((a, b) => a - b);
  return known[known.length >> 1];
};

/** The reactions that a structure has extrema of. */
export const forcesOf = ({ lacks, quantities, sketch }) => (lacks ? [] : Object.keys(sketch.forces).filter(name => name in quantities));
/** Of extrema of all reactions the largest, and where it is a guide's that of all pins; none unless each has a maximum. */
export function largestForces(structure, extrema) {
  const { guides, quantities } = structure, maxima = extrema.filter(one => one.kind !== "minimum").sort((one, two) => two.value - one.value || 0);      // two that are infinite differ by NaN
  const [largest] = maxima, pin = maxima.find(one => !guides.includes(one.quantity)), isPin = largest === pin;
  if (!largest || !forcesOf(structure).every(name => maxima.some(one => one.quantity === name))) return [];
  const guide = isPin ? "" : `: guide ${quantities[largest.quantity].symbol.replace(/^F_|[{}]/g, "")}`;
  return [{ ...largest, note: `largest force of all joints${guide}` }, ...(pin && !isPin ? [{ ...pin, note: "largest force of all pins" }] : [])];
}

export class Engine {
  /** structure: as the server gives it; module: its JavaScript; values: {parameter: number}, of the drive too; start: an input of the range that is followed. */
  constructor(structure, module, values, acceleration = 0, start = structure.start) {
    Object.assign(this, { structure, module, values, acceleration, start, rate: values["drive.speed"] ?? 1 });
    this.index = structure.index ??= Object.fromEntries(module.names.map((name, i) => [name, i]));
    this.constants = module.prepare(Object.fromEntries(Object.keys(module.parameters).filter(name => name in values && values[name] !== module.parameters[name]).map(name => [name, values[name]])));
    this.to = new Float64Array(module.names.length);
    this.status = 1;
  }
  get turnsFully() { return this.ranges.length === 1 && this.turns > 0; }
  get isAngle() { return this.structure.input.unit === "rad"; }

  // --- a pose ---
  /** Compute the pose at an input, and loads at its rate and acceleration; false if there is none. */
  at(x, rate = this.rate, acceleration = this.acceleration) {
    this.x = x;
    this.status = this.step(x, rate, acceleration, this.to);
    return this.status !== 1;
  }
  /** Results at an input; none of loads at a flat position, where they are 0/0 or rounding: status 2. */
  step(x, rate, acceleration, to) {
    const { module, index } = this, status = module.step(this.constants, x, rate, acceleration, to);
    if (status !== 0 || !(Math.abs(Math.sin(to[index.transmission_angle])) < 1e-9)) return status;
    to.fill(NaN, module.firstLoad);
    return 2;
  }
  get(name) { return this.to[this.index[name]]; }
  number(value) { return typeof value === "number" ? value : value in this.values ? this.values[value] : this.get(value); }
  frame(link) {
    const i = this.index[`frame.${link}.x`];
    return link === "ground" ? [0, 0, 1, 0] : [this.to[i], this.to[i + 1], this.to[i + 6], this.to[i + 7]];
  }
  point([link, along, across]) {
    const [x, y, c, s] = this.frame(link), u = this.number(along), v = this.number(across);
    return [x + u * c - v * s, y + u * s + v * c];
  }
  /** Velocity and acceleration of a point of a link: [v_x, v_y, a_x, a_y]. */
  rates([link, along, across]) {
    if (link === "ground") return [0, 0, 0, 0];
    const i = this.index[`frame.${link}.x`], [x, y] = this.point([link, along, across]), to = this.to;
    const dx = x - to[i], dy = y - to[i + 1], w = to[i + 8], a = to[i + 9];
    return [to[i + 2] - w * dy, to[i + 3] + w * dx, to[i + 4] - a * dy - w * w * dx, to[i + 5] + a * dx - w * w * dy];
  }
  joint(name) { return this.point(this.structure.sketch.joints[name][0]); }

  // --- where it closes ---
  /** Whether it has other numbers than those of which the server has answered. */
  get isChanged() { return Object.keys(this.module.parameters).some(name => this.values[name] !== this.structure.values[name]); }
  /** Ranges of the input, from the server while nothing has changed, else followed from the pose; `turns` of a full one. */
  get ranges() {
    if (this._ranges) return this._ranges;
    const { ranges, turns } = this.structure;
    [this._ranges, this.turns] = this.isChanged ? this.followed(this.start) : [ranges, turns];
    return this._ranges;
  }
  followed(start) {
    const [low, high] = [this.structure.ranges[0][0], this.structure.ranges.at(-1)[1]], h = this.isAngle ? TURN / 360 : (high - low) / 180, most = this.isAngle ? 360 : 720;
    for (let i = 0; i <= 360 && !this.at(start); i++) start += h * (i % 2 ? i : -i);   // the nearest pose
    if (!this.at(start)) return [[], 0];
    const ends = [-1, 1].map(sense => {
      let steps = 0;
      while (steps < most && this.at(start + sense * (steps + 1) * h)) steps++;
      let good = start + sense * steps * h, bad = good + sense * h;
      for (let i = 0; i < 50 && steps < most; i++) [good, bad] = (middle => (this.at(middle) ? [middle, bad] : [good, middle]))((good + bad) / 2);
      return good;
    });
    const turns = this.structure.turns || 1;
    return this.isAngle && ends[1] > start + TURN - 1e-9 ? [[[0, TURN * turns]], turns] : [[ends], 0];
  }
  /** How much of the input there is in all ranges. */
  get span() { return this.ranges.reduce((sum, [low, high]) => sum + high - low, 0); }
  /** An input in the turns that are shown. */
  counted(x) { return this.turnsFully ? ((x % this.span) + this.span) % this.span : x; }
  /** How far an input is outside of all ranges, an angle in any turn, and the input in them that is nearest: [away, input]; ends are left out, which may be toggles. */
  nearestInside(x) {
    if (!this.ranges.length || this.turnsFully) return [0, x];
    const { period } = this.structure;
    return this.ranges.map(([low, high]) => {
      const there = x + (period ? period * Math.round(((low + high) / 2 - x) / period) : 0), margin = 1e-6 * (high - low);
      return [Math.max(low - there, there - high, 0), Math.min(Math.max(there, low + margin), high - margin)];
    }).reduce((best, one) => (one[0] < best[0] ? one : best));
  }
  inside(x) { return this.nearestInside(x)[1]; }
  /** The input at which a joint is nearest to a place; a path crosses itself: far inputs count as farther. */
  nearest(joint, [x, y], from) {
    const { span } = this, inputs = this.sweep.inputs.map(x => x + (this.turnsFully ? span * Math.round((from - x) / span) : 0));
    const away = input => {
      const [u, v] = this.joint(joint), sum = Math.hypot(u - x, v - y) + (0.05 * this.size * Math.abs(input - from)) / span;
      return sum < Infinity ? sum : Infinity;         // NaN where there is no pose
    };
    const distances = this.ofSamples(i => away(inputs[i])), far = input => (this.at(this.inside(input)), away(input));
    let least = Math.min(...distances), best = inputs[distances.indexOf(least)];
    for (let step = span / inputs.length; step > 1e-7 * span; step /= 2) for (const next of [best - step, best + step]) {
      const there = far(next);
      if (there < least) [best, least] = [next, there];
    }
    return this.inside(best);
  }

  // --- over the input ---
  /** All results at evenly spread inputs over all ranges: {inputs, rows}; NaN where there is none. */
  get sweep() {
    if (this._sweep) return this._sweep;
    const inputs = [], width = this.to.length;
    for (const [low, high] of this.ranges) {
      const margin = this.turnsFully ? 0 : 1e-9 * (high - low);
      const count = this.turnsFully ? (SAMPLES - 1) * this.turns + 1 : SAMPLES;
      for (let i = 0; i < count; i++) inputs.push(low + margin + ((high - low - 2 * margin) * i) / (count - 1));
    }
    const all = new Float64Array(inputs.length * width), rows = inputs.map((_, i) => all.subarray(i * width, (i + 1) * width));
    inputs.forEach((x, i) => this.step(x, this.rate, this.acceleration, rows[i]));
    return (this._sweep = { inputs, rows });
  }
  /** What a function gives in the pose of each sample, of its index. */
  ofSamples(of) {
    const { to } = this, all = this.sweep.rows.map((row, i) => ((this.to = row), of(i)));
    this.to = to;
    return all;
  }
  /** Values of a quantity at the inputs of the sweep, as the formulas have them; those of the drive have rates of their own. */
  samples(name) {
    const { sweep: { inputs, rows }, index, structure: { drive, outputRate } } = this, to = new Float64Array(this.to.length);
    if (name in index) return rows.map(row => row[index[name]]);
    const at = (field, rate, acceleration) => inputs.map(x => (this.step(x, rate, acceleration, to), to[index[field]]));
    if (name === "bias") return at(drive, this.rate, 0);
    if (name.startsWith("holding_")) return at(drive, 0, 0);
    if (name === "mechanical_advantage") return at(outputRate, 1, 0).map(rate => 1 / rate);
    const held = at(drive, 0, 0);
    return at(drive, 0, 1).map((load, i) => load - held[i]);      // inertia
  }
  /** Samples as a curve: angles without jumps, the middle of each range from -pi to pi, at pi for half a turn, as the search has them. */
  curve(name) {
    const values = this.samples(name);
    if (this.structure.quantities[name].unit !== "rad") return values;
    const count = values.length / this.ranges.length;
    return this.ranges.flatMap((_, i) => {
      const angles = values.slice(i * count, (i + 1) * count);
      angles.forEach((angle, k) => { angles[k] = sameTurn(angle, angles[k - 1] ?? angle); });
      const turn = TURN * Math.ceil((Math.min(...angles) + Math.max(...angles)) / (2 * TURN) - 0.5 - 2 ** -30) || 0;
      return angles.map(angle => angle - turn);
    });
  }
  /** What adds up to a value of each unit, over the sine of the transmission angle; of medians. */
  get terms() {
    if (this._terms) return this._terms;
    const { index, isAngle, sweep: { rows }, structure: { links, size, sketch } } = this, frames = links.map(link => index[`frame.${link}.x`]), rate = Math.abs(this.rate);
    const sum = indices => median(rows.map(row => indices.reduce((all, i) => all + Math.abs(row[i] || 0), 0)));
    const omega = sum(frames.map(i => i + 8)) + rate / (isAngle ? 1 : size), alpha = sum(frames.map(i => i + 9)) + omega * omega, force = sum(Object.keys(sketch.forces).map(name => index[name]));
    const sine = median(rows.map(row => Math.abs(Math.sin(row[index.transmission_angle])))) || 1;
    const terms = { "": 1, rad: 1, m: size, "rad/s": omega, "rad/s^2": alpha, "m/s": size * omega, "m/s^2": size * alpha, N: force, "N m": size * force, W: rate * force * (isAngle ? size : 1) };
    return (this._terms = Object.fromEntries(Object.entries(terms).map(([unit, size]) => [unit, size / sine])));
  }
  /** Samples that differ by less are those of a constant: rounding, 64 eps of the terms, or more near toggles: SAME. */
  noise(name, values) {
    const size = median(values.map(Math.abs)), terms = this.terms[this.structure.quantities[name].unit] ?? size;
    return Math.max(128 * Number.EPSILON * terms, SAME * size);
  }
  /** The largest and the least sample of a quantity, or its constant value; none where it is steep, at a pole or a jump. */
  extremes(name) {
    const { inputs } = this.sweep, values = this.curve(name), known = [...values.keys()].filter(k => Number.isFinite(values[k]));
    if (!known.length) return [];
    const usual = median(values), [high, low] = [1, -1].map(sign => known.reduce((best, k) => (sign * values[k] > sign * values[best] ? k : best)));
    const row = (kind, k) => ({ quantity: name, kind, inputs: [inputs[k]], value: values[k], note: `of ${values.length} samples` }), noise = this.noise(name, values);
    if (values[high] - values[low] <= noise) return [{ ...row("constant", low), ...(Math.abs(values[low]) <= noise && { value: 0 }) }];
    const count = values.length / this.ranges.length, beside = (k, way) => (this.turnsFully ? (k + way + count - 1) % (count - 1) : Math.floor((k + way) / count) === Math.floor(k / count) ? k + way : k);
    const isSteep = k => [-1, 1].some(way => !(Math.abs(values[beside(k, way)] - values[k]) < STEEP * Math.min(Math.abs(values[k]), Math.abs(values[k] - usual))));
    return [row("maximum", high), row("minimum", low)].filter((_, i) => !isSteep([high, low][i]));
  }
  /** How large the mechanism is over all poses [m], and the box around its joints: [low, high]. */
  get box() {
    if (this._box) return this._box;
    const low = [Infinity, Infinity], high = [-Infinity, -Infinity], { joints, points, bars } = this.structure.sketch;
    const places = [...Object.values(joints).map(refs => refs[0]), ...Object.values(points), ...bars.flat()];
    this.ofSamples(i => i % 9 || places.forEach(place => this.point(place).forEach((value, k) => {
      if (Number.isFinite(value)) [low[k], high[k]] = [Math.min(low[k], value), Math.max(high[k], value)];
    })));
    return (this._box = Number.isFinite(low[0]) ? [low, high] : [[0, 0], [1, 1]]);
  }
  get size() { return Math.max(this.box[1][0] - this.box[0][0], this.box[1][1] - this.box[0][1]) || 1; }
  /** The path of a point over the cycle: a list of places, NaN between ranges. */
  path(point) { return this.ofSamples(() => this.point(point)); }
}
