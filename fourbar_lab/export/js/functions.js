// --- exact_sum
/** Correctly rounded sum of lengths, as Python's math.fsum; below 2^-50 of their sizes 0. */
function exact_sum(...terms) {
  const parts = [];
  let size = 0;
  for (let x of terms) {
    size += Math.abs(x);
    let kept = 0;
    for (let y of parts) {
      if (Math.abs(x) < Math.abs(y)) [x, y] = [y, x];
      const total = x + y, rest = y - (total - x);
      if (rest !== 0) parts[kept++] = rest;
      x = total;
    }
    parts.length = kept;
    if (Number.isNaN(x)) return NaN;
    if (x !== 0) parts.push(x);
  }
  let sum = parts.pop() ?? 0, low = 0;
  while (parts.length && low === 0) {
    const part = parts.pop(), total = sum + part;
    low = part - (total - sum);
    sum = total;
  }
  if (parts.length && low * Math.sign(parts.at(-1)) > 0) {      // a tie that the rest decides
    const total = sum + 2 * low;
    if (total - sum === 2 * low) sum = total;
  }
  return Math.abs(sum) <= 2 ** -50 * size ? 0 : sum;
}
// --- hypot
function hypot(x, y) {          // Math.hypot takes some ten times as long
  const square = x * x + y * y;
  return square > 1e-280 && square < 1e300 ? Math.sqrt(square) : Math.hypot(x, y);
}
// --- power
function power(base, exponent) {
  return exponent === 2 ? base * base : base ** exponent;
}
// --- power_of_two
/** The power of two next above the largest of the sizes of some lengths. */
function power_of_two(...lengths) {
  const largest = Math.max(...lengths.map(Math.abs));
  if (!(largest > 0 && largest < Infinity)) return largest;
  let power = 2 ** Math.floor(Math.log2(largest));              // log2 may be rounded up
  while (power > largest) power /= 2;
  while (power <= largest) power *= 2;
  return power;
}
// --- table
/** The value of a table of forces: pieces are cubics, [a, b, c, d, start], the first before all starts. */
function value_in(pieces, starts, place) {
  let low = 0, high = starts.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (place < starts[middle]) high = middle;
    else low = middle + 1;
  }
  const [a, b, c, d, start] = pieces[low], t = place - start;
  return ((a * t + b) * t + c) * t + d;
}
/** A place in a period that begins at `first`. */
function wrapped(place, first, period) {
  if (place - first >= 0 && place - first < period) return place;
  const rest = (place - first) % period;
  return first + (rest < 0 ? rest + period : rest);
}
// --- module
ABOUT
/** The numbers that can be changed, as the scene has them. */
export const parameters = PARAMETERS;
/** [name, least value, whether it is allowed itself] of parameters that have bounds. */
export const bounds = BOUNDS;
/** What step() gives, in this order, and where the loads begin. */
export const names = NAMES;
export const firstLoad = FIRST_LOAD;

FUNCTIONS
/** What follows from parameters alone, once for all steps; RangeError for one that cannot be. */
export function prepare(changed = {}) {
  for (const name in changed) {
    if (!Object.hasOwn(parameters, name)) throw new RangeError(`${name}: no parameter of this structure`);
    if (!Number.isFinite(changed[name])) throw new RangeError(`${name} = ${changed[name]}: must be a finite number`);
    if (name.endsWith('.mode') && changed[name] !== 1 && changed[name] !== 2) throw new RangeError(`${name} = ${changed[name]}: must be 1 or 2`);
  }
  const p = { ...parameters, ...changed };
  for (const [name, least, isAllowed] of bounds) {
    if (!(p[name] > least || (isAllowed && p[name] === least))) {
      throw new RangeError(`${name} = ${p[name]}: must be ${isAllowed ? 'at least' : 'above'} ${least}`);
    }
  }
PREPARATION
  return [KEPT];
}
function noMotion(to) {
  to.fill(NaN);
  return 1;
}
function noLoads(to) {
  to.fill(NaN, firstLoad);
  return 2;
}
/**
 * Motion and loads at an input, its rate and acceleration, into `to`, a Float64Array of
 * names.length. 0: all is there; 1: there is no motion, as Python raises OutOfRange, Toggle or
 * InvalidParameter; 2: there are no loads, as it locks itself or a spring has no direction.
 */
export function step(k, x0, x1, x2, to) {
  let refuse = noMotion;
STATEMENTS
}
/** The largest difference from poses that Python computed, over the full scale of each unit. */
export function selfCheck() {
  const k = prepare(), to = new Float64Array(names.length), differences = {}, scales = {};
  for (const [inputs, status, row] of recorded) {
    if (step(k, ...inputs, to) !== status) return Infinity;
    for (const [i, expected] of row.entries()) {
      if (expected === null) continue;
      let difference = Math.abs(to[i] - expected);
      if (units[i] === 'rad') difference = Math.min(difference, Math.abs(difference - 2 * Math.PI));
      if (!(difference <= (differences[units[i]] ??= 0))) differences[units[i]] = difference;
      scales[units[i]] = Math.max(scales[units[i]] ?? Number.MIN_VALUE, Math.abs(expected));
    }
  }
  return Math.max(...Object.keys(scales).map(unit => differences[unit] / scales[unit]));
}
export const units = UNITS;
const recorded = RECORDED;
