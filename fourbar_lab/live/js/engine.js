// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// A structure's module with the numbers of a scene: poses, ranges, curves, extrema. No document here.
export const TURN = 2 * Math.PI;
const SAMPLES = 361;      // of a range
const sameTurn = (angle, reference) => angle + TURN * Math.round((reference - angle) / TURN || 0);
/** The input of a maximum that is nearer to x than twice a step, by steps that are halved down to the least. */
function climbed(height, x, step, least) {
  let top = height(x);
  for (let h = step; h > least; h /= 2) {
    for (const next of [x - h, x + h]) {
      const there = height(next);
      if (there > top) [x, top] = [next, there];
    }
  }
  return x;
}
const median = values => [...values].sort((a, b) => a - b)[values.length >> 1];

/** The reactions that a structure has extrema of. */
export const forcesOf = ({ lacks, quantities, sketch }) => (lacks ? [] : Object.keys(sketch.forces).filter(name => name in quantities));
/** Of extrema of all reactions, sampled or answered, the largest, and where it is a guide's that of all pins. */
export function largestForces({ guides, quantities }, extrema) {
  const maxima = extrema.filter(one => one.kind !== "minimum").sort((one, two) => two.value - one.value || 0);      // two that are infinite differ by NaN
  const [largest] = maxima, pin = maxima.find(one => !guides.includes(one.quantity)), isPin = largest === pin;
  const guide = isPin ? "" : `: guide ${quantities[largest.quantity].symbol.replace(/^F_|[{}]/g, "")}`;
  return [...(largest ? [{ ...largest, note: `largest force of all joints${guide}` }] : []), ...(pin && !isPin ? [{ ...pin, note: "largest force of all pins" }] : [])];
}

export class Engine {
  /** structure: as the server gives it; module: its JavaScript; values: {parameter: number}, of the drive too. */
  constructor(structure, module, values, acceleration = 0) {
    Object.assign(this, { structure, module, values, acceleration, rate: values["drive.speed"] ?? 1 });
    structure.index ??= Object.fromEntries(module.names.map((name, i) => [name, i]));
    this.index = structure.index;
    const changed = {};
    for (const name in module.parameters) {
      if (values[name] !== module.parameters[name] && name in values) changed[name] = values[name];
    }
    this.constants = module.prepare(changed);
    [this.to, this.beside] = [0, 1].map(() => new Float64Array(module.names.length));
    this.status = 1;
  }
  get turnsFully() { return this.ranges.length === 1 && this.ranges[0].turns; }
  get isAngle() { return this.structure.input.unit === "rad"; }

  // --- a pose ---
  /** Compute the pose at an input, and loads at its rate and acceleration; false if there is none. */
  at(x, rate = this.rate, acceleration = this.acceleration) {
    this.x = x;
    this.status = this.module.step(this.constants, x, rate, acceleration, this.to);
    return this.status !== 1;
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
  /** Ranges of the input, from the server while nothing has changed, else followed from the pose. */
  get ranges() {
    if (this._ranges) return this._ranges;
    const { values, ranges, turns } = this.structure;
    const isChanged = Object.keys(this.module.parameters).some(name => this.values[name] !== values[name]);
    this._ranges = isChanged ? this.followed(this.start ?? this.structure.start) : ranges.map(ends => [...ends]);
    if (!isChanged && turns) this._ranges[0].turns = turns;
    return this._ranges;
  }
  followed(start) {
    const whole = this.structure.ranges.at(-1)[1] - this.structure.ranges[0][0];
    const h = this.isAngle ? TURN / 360 : whole / 180, most = this.isAngle ? 360 : 720;
    for (let i = 0; i <= 360 && !this.at(start); i++) start += h * (i % 2 ? i : -i);   // the nearest pose
    if (!this.at(start)) return [];
    const ends = [-1, 1].map(sense => {
      let good = start, bad = NaN;
      for (let i = 1; i <= most && Number.isNaN(bad); i++) {
        if (this.at(start + sense * i * h)) good = start + sense * i * h;
        else bad = start + sense * i * h;
      }
      if (Number.isNaN(bad)) return sense * Infinity;
      for (let i = 0; i < 50; i++) [good, bad] = (middle => (this.at(middle) ? [middle, bad] : [good, middle]))((good + bad) / 2);
      return good;
    });
    if (ends[1] === Infinity && this.isAngle) {
      const full = [0, TURN * (this.structure.turns || 1)];
      full.turns = this.structure.turns || 1;
      return [full];
    }
    return [ends.map((end, i) => (Number.isFinite(end) ? end : start + (i ? 1 : -1) * most * h))];
  }
  /** The input in the ranges that is nearest to one; ends are left out, which may be toggles. */
  inside(x) {
    if (!this.ranges.length) return x;
    if (this.turnsFully) return x;
    const away = ([low, high]) => Math.max(low - x, x - high, 0);
    const [low, high] = this.ranges.reduce((best, range) => (away(range) < away(best) ? range : best));
    const margin = 1e-6 * (high - low);
    return Math.min(Math.max(x, low + margin), high - margin);
  }
  /** The input at which a joint is nearest to a place, of the samples, refined; a path crosses itself: far inputs count as farther. */
  nearest(joint, [x, y], from) {
    const span = this.ranges.reduce((sum, [low, high]) => sum + high - low, 0), ref = this.structure.sketch.joints[joint][0];
    const far = input => {
      const [u, v] = this.point(ref);
      return Math.hypot(u - x, v - y) + (0.05 * this.size * Math.abs(input - from)) / span;
    };
    const inputs = this.sweep.inputs.map(x => x + (this.turnsFully ? span * Math.round((from - x) / span) : 0)), distances = this.ofSamples(i => far(inputs[i]));
    const best = distances.reduce((least, distance, i) => (distance < distances[least] || Number.isNaN(distances[least]) ? i : least), 0);
    return this.inside(climbed(input => (this.at(this.inside(input)) ? -far(input) : -Infinity), inputs[best], span / inputs.length, 1e-7 * span));
  }

  // --- over the input ---
  /** Results at an input; at a flat position, where loads are 0/0 or rounding, the loads a billionth of the range beside it. */
  step(x, rate, acceleration, to) {
    const { module, constants, beside, index } = this, status = module.step(constants, x, rate, acceleration, to);
    const isWithinRounding = status === 0 && Math.abs(Math.sin(to[index.transmission_angle])) < 1e-9;
    if (status !== 2 && !isWithinRounding) return status;
    const [low, high] = this.ranges[0];
    module.step(constants, x + 1e-9 * (high - low), rate, acceleration, beside);
    to.set(beside.subarray(module.firstLoad), module.firstLoad);
    return 2;
  }
  /** All results at evenly spread inputs over all ranges: {inputs, rows, isFlat: somewhere beside a flat position}; NaN where there is none. */
  get sweep() {
    if (this._sweep) return this._sweep;
    const inputs = [], width = this.to.length;
    for (const [low, high] of this.ranges) {
      const margin = this.turnsFully ? 0 : 1e-9 * (high - low);
      const count = this.turnsFully ? (SAMPLES - 1) * this.ranges[0].turns + 1 : SAMPLES;
      for (let i = 0; i < count; i++) inputs.push(low + margin + ((high - low - 2 * margin) * i) / (count - 1));
    }
    const all = new Float64Array(inputs.length * width), rows = inputs.map((_, i) => all.subarray(i * width, (i + 1) * width));
    const isFlat = inputs.map((x, i) => this.step(x, this.rate, this.acceleration, rows[i])).some(Boolean);
    return (this._sweep = { inputs, rows, isFlat });
  }
  /** What a function gives in the pose of each sample, of its index. */
  ofSamples(of) {
    const { to } = this, all = this.sweep.rows.map((row, i) => ((this.to = row), of(i)));
    this.to = to;
    return all;
  }
  /** A function x -> value of a quantity; those of the drive have rates of their own. */
  valueOf(name) {
    const { drive, outputRate } = this.structure, to = new Float64Array(this.to.length);
    const run = (x, rate, acceleration, i) => (this.step(x, rate, acceleration, to), to[i]);
    const i = this.index[name], load = this.index[drive];
    if (i !== undefined) return x => run(x, this.rate, this.acceleration, i);
    if (name === "bias") return x => run(x, this.rate, 0, load);
    if (name.startsWith("holding_")) return x => run(x, 0, 0, load);
    if (name === "inertia") return x => run(x, 0, 1, load) - run(x, 0, 0, load);
    return x => 1 / run(x, 1, 0, this.index[outputRate]);      // mechanical_advantage
  }
  /** Values at the inputs of the sweep; angles without jumps, the middle of each range from -pi to pi, at pi for half a turn, as the search has them. */
  curve(name) {
    const { inputs, rows } = this.sweep, i = this.index[name], value = i === undefined && this.valueOf(name), values = rows.map((row, k) => (value ? value(inputs[k]) : row[i]));
    if (this.structure.quantities[name].unit !== "rad") return { inputs, values };
    const count = values.length / this.ranges.length;
    return { inputs, values: this.ranges.flatMap((_, i) => {
      const angles = values.slice(i * count, (i + 1) * count);
      angles.forEach((angle, k) => { angles[k] = sameTurn(angle, angles[k - 1] ?? angle); });
      const turn = TURN * Math.ceil((Math.min(...angles) + Math.max(...angles)) / (2 * TURN) - 0.5 - 2 ** -30) || 0;
      return angles.map(angle => angle - turn);
    }) };
  }
  /** What rounding makes of a quantity, by its unit, as the search of fourbar show has it: 64 eps of the terms that add up, of other units of its usual size, over the sine of the transmission angle; of medians. */
  get rounding() {
    if (this._rounding) return this._rounding;
    const { index, isAngle, sweep: { rows }, structure: { links, size, sketch } } = this, frames = links.map(link => index[`frame.${link}.x`]);
    const sum = indices => median(rows.map(row => indices.reduce((all, i) => all + Math.abs(row[i] || 0), 0)));
    const rate = Math.abs(this.rate), omega = sum(frames.map(i => i + 8)) + rate / (isAngle ? 1 : size), alpha = sum(frames.map(i => i + 9)) + omega * omega;
    const force = sum(Object.keys(sketch.forces).map(name => index[name])), sine = median(rows.map(row => Math.abs(Math.sin(row[index.transmission_angle])))) || 1;
    const terms = { "": 1, rad: 1, m: size, "rad/s": omega, "rad/s^2": alpha, "m/s": size * omega, "m/s^2": size * alpha, N: force, "N m": size * force, W: rate * force * (isAngle ? size : 1) };
    return (this._rounding = (unit, usual) => (64 * Number.EPSILON * (terms[unit] ?? usual)) / sine);
  }
  /** Where samples turn, [{k, sign, inward: at an end of a range the way into it}], maxima and minima by turns; variations of less than `noise` are none. */
  turns(values, noise, winds) {
    const n = values.length, joins = this.turnsFully && !winds;           // the last sample is the first one again
    const top = joins ? values.indexOf(Math.max(...values.filter(value => !Number.isNaN(value)))) : 0, count = this.turnsFully ? n : SAMPLES;
    return this.ranges.flatMap((_, i) => {
      const all = Array.from({ length: count }, (_, k) => (joins ? (k + top) % (n - 1) : k + i * SAMPLES)), turns = [];
      let [low, high, sign] = [all[0], all[0], 0];
      for (const k of all) {
        if (values[k] > values[high] || Number.isNaN(values[high])) high = k;
        if (values[k] < values[low] || Number.isNaN(values[low])) low = k;
        if (sign <= 0 && values[k] > values[low] + noise) [high, sign] = (turns.push({ k: low, sign: -1 }), [k, 1]);
        else if (sign >= 0 && values[k] < values[high] - noise) [low, sign] = (turns.push({ k: high, sign: 1 }), [k, -1]);
      }
      if (joins) return turns;
      if (winds) return turns.slice(1);
      if (sign) turns.push({ sign });
      return turns.map((turn, j) => (j && j < turns.length - 1 ? turn : { ...turn, k: all.at(j ? -1 : 0), inward: j ? -1 : 1 }));
    }).filter(({ k, inward }) => [inward ? k : (k || n - 1) - 1, k, inward ? k : k + 1].every(i => !Number.isNaN(values[i])));
  }
  /** Extrema of a quantity: those of the samples, refined on the formula, and ends of ranges, or a constant; pairs nearer than a sample are lost. */
  extrema(name) {
    const { unit } = this.structure.quantities[name], { inputs, values } = this.curve(name), valueAt = this.valueOf(name);
    const [usual, usualSize] = [values, values.map(Math.abs)].map(all => median(all.filter(Number.isFinite))), noise = this.rounding(unit, usualSize);
    if (values.every(value => !(Math.abs(value - usual) > noise))) return usual === undefined ? [] : [{ quantity: name, kind: "constant", input: inputs[0], value: usualSize <= noise ? 0 : usual, isGlobal: true, note: "" }];
    const winds = unit === "rad" && this.turnsFully && Math.abs(values.at(-1) - values[0]) > Math.PI, turns = this.turns(values, noise, winds);
    const found = turns.map(({ k, sign, inward }) => {
      const value = unit === "rad" ? x => sameTurn(valueAt(x), values[k]) : valueAt;
      // towards a pole values grow, as one over the distance or over its root; beyond a jump they have grown once
      const isPole = (x, beside) => {
        const [near, far, farther] = [1, 3, 9].map(times => Math.abs(value(x + times * beside)));
        return near > 1.5 * far && far > 1.5 * farther && near > usualSize;
      };
      const h = inputs[inward < 0 ? k - 1 : k + 1] - inputs[k], kind = sign > 0 ? "maximum" : "minimum";
      if (inward) {
        // f = a + b sqrt(d) + c d beside a toggle, and with b = 0 at the end of a stroke: of 3 f(m) - 3 f(4 m) + f(9 m) stay
        // (3 - 3 + 1) a + (3 - 6 + 3) b sqrt(m) + (3 - 12 + 9) c m = a
        const beside = (inward * 1e-9 * Math.abs(h) * (SAMPLES - 1)) / (1 - 2e-9), x = inputs[k] - beside, runsAway = isPole(x, beside);
        return { quantity: name, kind, input: x, value: runsAway ? sign * Infinity : 3 * values[k] - 3 * value(x + 4 * beside) + value(x + 9 * beside), note: "limit" };
      }
      const x = climbed(input => sign * value(input), inputs[k], h / 2, 1e-11 * h), runsAway = isPole(x, 1e-6 * h);
      return { quantity: name, kind, input: x < 0 && this.turnsFully ? x + inputs.at(-1) : x, value: runsAway ? sign * Infinity : value(x), note: runsAway ? "limit" : "" };
    });
    // of loads at change points, that stand for those beside flat positions, none is said to be the largest
    const isSure = !this.sweep.isFlat || this.index[name] < this.module.firstLoad, [least, most] = [Math.min, Math.max].map(end => end(...found.map(one => one.value)));
    return found.map(one => {
      const end = one.kind === "maximum" ? most : least, isGlobal = one.value === end || Math.abs(one.value - end) <= noise;
      return { ...one, isGlobal, note: [isGlobal && isSure && "global", one.note].filter(Boolean).join(" ") };
    });
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
