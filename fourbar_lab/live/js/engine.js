// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// A structure's module with the numbers of a scene: poses, ranges, curves, extrema. No document here.
export const TURN = 2 * Math.PI;
const SAMPLES = 361;      // of a range
const GOLDEN = 0.6180339887498949;

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
    this.to = new Float64Array(module.names.length);
    this.status = 1;
  }
  /** Another engine with these parameters; RangeError names one that this structure does not have. */
  with(changed) {
    for (const name in changed) {
      if (!(name in this.module.parameters)) throw new RangeError(`${name}: no parameter of this structure`);
    }
    return new Engine(this.structure, this.module, { ...this.values, ...changed }, this.acceleration);
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
  /** Where a place of the plane is on a link in this pose: [along, across]. */
  local(link, [x, y]) {
    const [x0, y0, c, s] = this.frame(link);
    return [(x - x0) * c + (y - y0) * s, (y - y0) * c - (x - x0) * s];
  }

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
      while (Math.abs(bad - good) > 1e-12 * whole) {
        const middle = (good + bad) / 2;
        if (middle === good || middle === bad) break;
        if (this.at(middle)) good = middle;
        else bad = middle;
      }
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
    const { inputs, rows } = this.sweep, { to } = this;
    let best = from, least = Infinity;
    const take = input => {
      const distance = far(input);
      if (distance < least) [best, least] = [input, distance];
    };
    rows.forEach((row, i) => {
      this.to = row;
      take(inputs[i] + (this.turnsFully ? span * Math.round((from - inputs[i]) / span) : 0));
    });
    this.to = to;
    for (let h = span / rows.length; h > 1e-7 * span; h /= 2) {
      for (const input of [best - h, best + h].map(next => this.inside(next))) if (this.at(input)) take(input);
    }
    return best;
  }

  // --- over the input ---
  /** All results at evenly spread inputs over all ranges: {inputs, rows}; NaN where there is none. */
  get sweep() {
    if (this._sweep) return this._sweep;
    const inputs = [], width = this.to.length;
    for (const [low, high] of this.ranges) {
      const margin = this.turnsFully ? 0 : 1e-9 * (high - low);
      const count = this.turnsFully ? (SAMPLES - 1) * this.ranges[0].turns + 1 : SAMPLES;
      for (let i = 0; i < count; i++) inputs.push(low + margin + ((high - low - 2 * margin) * i) / (count - 1));
    }
    const all = new Float64Array(inputs.length * width);
    const rows = inputs.map((x, i) => {
      const row = all.subarray(i * width, (i + 1) * width);
      this.module.step(this.constants, x, this.rate, this.acceleration, row);
      return row;
    });
    return (this._sweep = { inputs, rows });
  }
  /** A function x -> value of a quantity; those of the drive have rates of their own. */
  valueOf(name) {
    const { drive, outputRate } = this.structure, to = new Float64Array(this.to.length);
    const run = (x, rate, acceleration, i) => (this.module.step(this.constants, x, rate, acceleration, to), to[i]);
    const i = this.index[name], load = this.index[drive];
    if (i !== undefined) return x => run(x, this.rate, this.acceleration, i);
    if (name === "bias") return x => run(x, this.rate, 0, load);
    if (name.startsWith("holding_")) return x => run(x, 0, 0, load);
    if (name === "inertia") return x => run(x, 0, 1, load) - run(x, 0, 0, load);
    return x => 1 / run(x, 1, 0, this.index[outputRate]);      // mechanical_advantage
  }
  curve(name) {
    const { inputs, rows } = this.sweep, i = this.index[name], value = i === undefined && this.valueOf(name);
    return { inputs, values: rows.map((row, k) => (value ? value(inputs[k]) : row[i])) };
  }
  /** Extrema of a quantity: those of the samples, refined on the formula, and ends of ranges; pairs nearer than a sample are lost. */
  extrema(name) {
    const { inputs, values } = this.curve(name), value = this.valueOf(name), found = [], n = values.length;
    const sizes = values.map(Math.abs).filter(Number.isFinite).sort((a, b) => a - b), size = sizes.at(-1), usual = sizes[sizes.length >> 1];
    if (Math.max(...values) - Math.min(...values) <= 1e-12 * size) return [];
    const joins = this.turnsFully;      // the last sample is the first one again
    for (let k = 0; k < (joins ? n - 1 : n); k++) {
      const inward = joins ? 0 : k % SAMPLES === 0 ? 1 : k % SAMPLES === SAMPLES - 1 ? -1 : 0;       // at an end of a range
      const here = values[k], after = values[inward < 0 ? k - 1 : k + 1], before = inward ? after : values[(k || n - 1) - 1];
      const sign = here > before && here >= after ? 1 : here < before && here <= after ? -1 : 0;
      if (!sign) continue;
      const h = inputs[inward < 0 ? k - 1 : k + 1] - inputs[k], kind = sign > 0 ? "maximum" : "minimum";
      if (inward) {
        // beside a toggle values go with the root of the distance, or as one over it
        const margin = (1e-9 * Math.abs(h) * (SAMPLES - 1)) / (1 - 2e-9), far = value(inputs[k] + 3 * inward * margin);
        const isPole = Math.abs(here) > 1.5 * Math.abs(far) && Math.abs(here) > usual;
        found.push({ quantity: name, input: inputs[k] - inward * margin, value: isPole ? sign * Infinity : 2 * here - far, kind, note: "limit" });
        continue;
      }
      if (Math.abs(here) > 1e12 * Math.max(Math.abs(before), Math.abs(after))) continue;
      let low = inputs[k] - h, high = inputs[k] + h, a = high - GOLDEN * (high - low), b = low + GOLDEN * (high - low);
      let [atA, atB] = [sign * value(a), sign * value(b)];
      for (let i = 0; i < 36; i++) {
        if (atA > atB) {
          [high, b, atB] = [b, a, atA];
          atA = sign * value((a = high - GOLDEN * (high - low)));
        } else {
          [low, a, atA] = [a, b, atB];
          atB = sign * value((b = low + GOLDEN * (high - low)));
        }
      }
      const x = (low + high) / 2, refined = value(x), isPole = Math.abs(refined) >= (1e9 * usual || Infinity);
      found.push({ quantity: name, input: x < 0 && joins ? x + inputs[n - 1] : x, value: isPole ? sign * Infinity : refined, kind });
    }
    const all = found.map(one => one.value), global = { maximum: Math.max(...all), minimum: Math.min(...all) };
    return found.map(one => ({ ...one, isGlobal: one.value === global[one.kind], note: [one.value === global[one.kind] && "global", one.note].filter(Boolean).join(" ") }));
  }
  /** The largest force of all joints, and where it is a guide's that of all pins, as extrema; none without loads. */
  get largestForces() {
    const { guides, quantities } = this.structure, loads = Object.keys(this.structure.sketch.forces).filter(name => quantities[name]);
    const maxima = loads.flatMap(name => this.extrema(name)).filter(one => one.kind === "maximum").sort((one, two) => two.value - one.value || 0);
    const [largest] = maxima, pin = maxima.find(one => !guides.includes(one.quantity)), isPin = largest === pin;
    return largest ? [{ ...largest, note: `largest force of all joints${isPin ? "" : `: guide ${quantities[largest.quantity].symbol.replace(/^F_|[{}]/g, "")}`}` }, ...(pin && !isPin ? [{ ...pin, note: "largest force of all pins" }] : [])] : [];
  }
  /** How large the mechanism is over all poses [m], and the box around its joints: [low, high]. */
  get box() {
    if (this._box) return this._box;
    const low = [Infinity, Infinity], high = [-Infinity, -Infinity], { joints, points, bars } = this.structure.sketch;
    const to = this.to, add = place => place.forEach((value, i) => {
      if (Number.isFinite(value)) [low[i], high[i]] = [Math.min(low[i], value), Math.max(high[i], value)];
    });
    const places = [...Object.values(joints).map(refs => refs[0]), ...Object.values(points), ...bars.flat()];
    for (const row of this.sweep.rows.filter((_, i) => i % 9 === 0)) {
      this.to = row;
      for (const place of places) add(this.point(place));
    }
    this.to = to;
    return (this._box = Number.isFinite(low[0]) ? [low, high] : [[0, 0], [1, 1]]);
  }
  get size() { return Math.max(this.box[1][0] - this.box[0][0], this.box[1][1] - this.box[0][1]) || 1; }
  /** The path of a point over the cycle: a list of places, NaN between ranges. */
  path(point) {
    const to = this.to, places = this.sweep.rows.map(row => ((this.to = row), this.point(point)));
    this.to = to;
    return places;
  }
}
