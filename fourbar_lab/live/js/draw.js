// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// Draw a machine and change its shape: clicks and drags become parameters of the scene.
//
// A sketch has the places of all joints in the plane, in the pose that is shown. A drag moves one of
// them, and lengths, modes and points of links follow from the places. So a joint stands once, and all
// that hangs on it comes along.

import { draw } from './picture.js';
import { html } from './panel.js';
import { leafOf, withLeaf } from './page.js';
const NEW_RODS = { density: 7850.0, radius: 0.005 };    // steel, 10 mm
const NEW_SPRING = 1000;            // [N/m]
const NEW_FORCE = 400;              // [N], an arrow half as long as the picture is wide
const NEAR_PIXELS = 22;
const GUIDED = ['RRP', 'RPP', 'PRP'];
const DRIVEN = { crank: 'crank', slide: 'slider', cylinder: 'crank' };      // {linkage.input: the link that is driven}
const FIRST = { RRR: 'crank', RRP: 'slide', RPR: 'cylinder' };              // {tool of the first click: drive of a new machine}
const offset = (a, b) => [b[0] - a[0], b[1] - a[1]];
const distance = (a, b) => Math.hypot(b[0] - a[0], b[1] - a[1]);
const cross = (u, v) => u[0] * v[1] - u[1] * v[0];
const dot = (u, v) => u[0] * v[0] + u[1] * v[1];
const angleOf = u => Math.atan2(u[1], u[0]);
const tidy = value => Number(value.toPrecision(12));
const threeDigits = value => Number(value.toPrecision(3));
/** A frame: where it is, and the direction of its x axis. */
const frameAt = (at, angle) => ({ at, angle, unit: [Math.cos(angle), Math.sin(angle)] });
const frameTo = (a, b) => frameAt(a, angleOf(offset(a, b)));
const localIn = (frame, place) => [dot(frame.unit, offset(frame.at, place)), cross(frame.unit, offset(frame.at, place))];
const placeIn = (frame, [u, v]) => [frame.at[0] + u * frame.unit[0] - v * frame.unit[1], frame.at[1] + u * frame.unit[1] + v * frame.unit[0]];
const GROUND = frameAt([0, 0], 0);
const must = (isSo, words) => { if (!isSo) throw new RangeError(words); };

/** Where circles about two centres meet, on the side of a place; null: nowhere. */
function meeting(a, r, b, s, near) {
  const d = distance(a, b), u = (d * d + r * r - s * s) / (2 * d), square = r * r - u * u;
  return square > 0 ? placeIn(frameTo(a, b), [u, Math.sign(localIn(frameTo(a, b), near)[1]) * Math.sqrt(square)]) : null;
}

/** The body of a rod of the scene's section, round or flat. */
function rodOf({ density, radius, width, thickness }, length) {
  const mass = density * length * (radius ? Math.PI * radius ** 2 : width * thickness);
  return { mass, cg_along: length / 2, inertia: mass * ((radius ? 3 * radius ** 2 : width ** 2) + length ** 2) / 12 };
}

/** The machine of a four-bar or slider-crank, with the same links and range, in the same frame; null of others. */
export function machineOf(scene) {
  const { kind = 'four_bar', a1, a2, a3, a4, offset: y = 0, mode = 2, input = 'crank', range, joints = [] } = scene.linkage || {}, [pivot, a = 'A', inner, c = 'C'] = joints;
  if (input !== 'crank' || !['four_bar', 'slider_crank'].includes(kind)) return null;
  const points = { [a]: { link: 'crank', along: a1 } }, common = { first: a, links: ['coupler', 'output'], length_1: a2, mode, ...(inner && { inner }) };
  const machine = { ...scene, linkage: { kind: 'machine', dyads: ['d1'], points, ...(range && { range }), ...(pivot && { pivot }) } };
  if (kind === 'four_bar') points[c] = { x: a4, y: 0 };
  machine.dyads = { d1: kind === 'four_bar' ? { kind: 'RRR', second: c, length_2: a3, ...common } : { kind: 'RRP', second: { link: 'ground', along: 0, across: y }, direction_2: 0, ...common } };
  if (scene.bodies?.rods && scene.bodies.crank?.mass === undefined) machine.bodies = { ...scene.bodies, crank: rodOf(scene.bodies.rods, a1) };
  return machine;
}

/**
 * The places of all joints of a scene (numbers in SI) in the pose of an engine at the input x.
 *
 * drive: linkage.input, with the link `driven`; points {name: {link, at, pin: dyad whose inner pin it is, isOnLine}}, dyads
 * [{name, kind, links, first, second: name or guide {link, at}, inner, direction, mode}], riders [{path, link, at, pin, isOnLine}],
 * frames {link: as shown}. RangeError where it cannot be drawn on.
 */
export function sketchOf(scene, engine, x) {
  const { linkage = {}, dyads = {}, cylinder = {} } = scene, { kind, carrier = 'ground', input: drive = 'crank', dyads: names = [] } = linkage;
  must(kind === 'machine' && carrier === 'ground' && (cylinder.base?.link ?? 'ground') === 'ground', 'Only a machine that is driven from the ground can be drawn on: begin with New');
  const sketch = newSketch(drive, x, cylinder.links), rodEnds = {};
  for (const link of [sketch.driven, ...sketch.cylinder, ...names.flatMap(name => dyads[name].links)]) {
    const [x0, y0, c, s] = engine.frame(link);
    sketch.frames[link] = frameAt([x0, y0], Math.atan2(s, c));
  }
  for (const name of names) dyads[name].links.forEach((link, i) => { if (dyads[name][`length_${i + 1}`] !== undefined) rodEnds[link] = { name, length: dyads[name][`length_${i + 1}`] }; });
  const size = Math.max(...Object.values(rodEnds).map(rod => rod.length), 0), tiny = 1e-9 * size;
  /** A point of a scene, however it is given. */
  const pointOf = ({ link = 'ground', x: px, y: py, along = px ?? 0, across = py ?? 0, distance_1: d1, distance_2: d2, side }) => {
    const rod = rodEnds[link];
    if (d2 !== undefined) along = d1 === undefined ? rod.length - d2 : (rod.length + (d1 - d2) * (d1 + d2) / rod.length) / 2;
    if (d1 !== undefined) across = (side === 'left' ? 1 : -1) * Math.sqrt(Math.max(0, d1 * d1 - along * along));
    const isPin = rod && Math.abs(along - rod.length) < tiny && Math.abs(across) < tiny;
    return { link, at: placeIn(sketch.frames[link], [along, across]), pin: isPin ? rod.name : null, isFirst: Math.abs(along) < tiny && Math.abs(across) < tiny, isOnLine: Math.abs(across) < tiny };
  };
  for (const name of names) {
    const dyad = dyads[name], isRod = ['RRR', 'RRP'].includes(dyad.kind), ends = {};
    for (const end of ['first', 'second']) {
      const point = pointOf(typeof dyad[end] === 'string' ? linkage.points[dyad[end]] : dyad[end]);
      if (typeof dyad[end] === 'string') sketch.points[ends[end] = dyad[end]] ||= point;
      else if (end === 'second' && GUIDED.includes(dyad.kind)) ends[end] = point;
      else {                                              // from now on it has a name, one for all dyads there
        const same = Object.keys(sketch.points).find(of => sketch.points[of].link === point.link && distance(sketch.points[of].at, point.at) < tiny);
        const letter = engine.structure.sketch.letters[`${name}_${end}`], known = { ...sketch.points, ...linkage.points };
        sketch.points[ends[end] = same || (!letter || letter in known ? freshName(known) : letter)] ||= point;
      }
    }
    const guide = typeof ends.second === 'string' ? sketch.points[ends.second] : ends.second;
    sketch.dyads.push({ name, kind: dyad.kind, links: dyad.links, ...ends, inner: isRod ? engine.joint(`${name}_inner`) : null,
      direction: dyad.kind === 'RRP' ? sketch.frames[guide.link].angle + (dyad.direction_2 ?? 0) : null, mode: dyad.mode ?? 2 });
  }
  const ride = (path, of) => sketch.riders.push({ path, ...pointOf(of) });
  for (const [name, of] of Object.entries(scene.points || {})) ride(`points.${name}`, of);
  for (const [name, of] of Object.entries(scene.springs || {})) for (const end of ['first', 'second']) ride(`springs.${name}.${end}`, of[end] || {});
  for (const [link, of] of Object.entries(scene.external || {})) if (of?.force_x || of?.force_y) ride(`external.${link}`, { ...of, link });
  for (const [name, of] of Object.entries(scene.forces || {})) if (of.acts !== 'couple') ride(`forces.${name}`, of);
  if (drive === 'cylinder') for (const [end, link] of [['base', 'ground'], ['pin', 'crank']]) ride(`cylinder.${end}`, { ...cylinder[end], link });
  return sketch;
}
const newSketch = (drive, x, rodAndTube = ['rod', 'tube']) => ({ drive, driven: DRIVEN[drive], cylinder: drive === 'cylinder' ? rodAndTube : [], x, points: {}, dyads: [], riders: [], frames: { ground: GROUND } });
function freshName(taken) {
  for (let i = 0; ; i++) {
    const name = 'ABCDEGHIJKLMNPQRSTUVWXYZ'[i % 24] + (i < 24 ? '' : Math.floor(i / 24));
    if (!(name in taken)) return name;
  }
}
const placeOfEnd = (sketch, end) => (typeof end === 'string' ? sketch.points[end] : end).at;
const pointsOf = sketch => [...Object.values(sketch.points), ...sketch.riders];
/** The pin of the driven link, with which it moves. */
const drivenPin = sketch => pointsOf(sketch).find(point => point.link === sketch.driven);
/** Where a cylinder that drives ends: on the ground and on the crank. */
const cylinderEnds = sketch => ['base', 'pin'].map(end => sketch.riders.find(rider => rider.path === `cylinder.${end}`).at);

/**
 * Bring the frames of all links of a sketch after a move; points on lines and pins of dyads follow.
 *
 * Rods whose joints moved since `before` get lengths of three digits; `held` is the point that a hand holds.
 */
function settle(sketch, before, held) {
  const { frames, cylinder: [rod, tube] } = sketch, pins = {};
  const follow = links => {
    for (const point of pointsOf(sketch)) {
      if (!links.includes(point.link)) continue;
      if (point.pin) point.at = pins[point.pin];
      else if (point.isOnLine && point !== held) point.at = placeIn(frames[point.link], [point.isFirst ? 0 : localIn(frames[point.link], point.at)[0], 0]);
    }
  };
  follow([sketch.driven]);
  if (rod) {
    const [base, pin] = cylinderEnds(sketch), bar = frameTo(base, pin);
    [frames[rod], frames[tube], sketch.x] = [frameAt(pin, bar.angle), bar, distance(base, pin)];
    follow(sketch.cylinder);
  }
  for (const dyad of sketch.dyads) {
    const was = before?.dyads.find(of => of.name === dyad.name), p = placeOfEnd(sketch, dyad.first), q = placeOfEnd(sketch, dyad.second);
    const hasMoved = !was || distance(p, placeOfEnd(before, was.first)) > 0 || distance(q, placeOfEnd(before, was.second)) > 0 || dyad.inner && distance(dyad.inner, was.inner) > 0;
    if (dyad.kind === 'RRR') {
      if (hasMoved) dyad.inner = meeting(p, threeDigits(distance(p, dyad.inner)), q, threeDigits(distance(q, dyad.inner)), dyad.inner) || dyad.inner;
      [frames[dyad.links[0]], frames[dyad.links[1]]] = [frameTo(p, dyad.inner), frameTo(q, dyad.inner)];
    } else if (dyad.kind === 'RRP') {
      const guide = frameAt(q, dyad.direction);
      if (dyad.second === held || sketch.points[dyad.second] === held) dyad.inner = placeIn(guide, [localIn(guide, dyad.inner)[0], 0]);
      else if (hasMoved && typeof dyad.second !== 'string') dyad.second.at = placeIn(guide, [0, localIn(guide, dyad.inner)[1]]);
      [frames[dyad.links[0]], frames[dyad.links[1]]] = [frameTo(p, dyad.inner), frameAt(dyad.inner, frames[dyad.links[1]]?.angle ?? dyad.direction)];
    } else if (dyad.kind === 'RPR') {
      const turn = frames[dyad.links[1]] && was ? frames[dyad.links[1]].angle - frameTo(placeOfEnd(before, was.second), placeOfEnd(before, was.first)).angle : 0;
      const bar = frameTo(q, p).angle + turn;
      [frames[dyad.links[0]], frames[dyad.links[1]]] = [frameAt(p, bar), frameAt(q, bar)];
    }
    if (dyad.inner) pins[dyad.name] = dyad.inner;
    follow(dyad.links);
  }
}

/** A scene with other values at paths; null deletes. */
const written = (scene, set) => Object.entries(set).reduce((made, [path, value]) => withLeaf(made, path, value), scene);

/** What a sketch changes in a scene (numbers in SI): {path: value, subtree or null}; `before` is the sketch of the scene. */
export function changesOf(scene, sketch, before = null, held = null) {
  settle(sketch, before, held);
  const { frames } = sketch, set = {}, { linkage = {}, dyads = {} } = scene;
  const places = [...sketch.dyads.map(dyad => dyad.inner), ...pointsOf(sketch).map(point => point.at)].filter(Boolean);
  const tiny = 1e-11 * Math.max(...places.map(at => Math.hypot(...at)));
  const put = (path, value, old) => {
    const isSame = typeof value === 'number' ? Math.abs(value - (old ?? 0)) <= tiny : value === old;
    if (!isSame) set[path] = typeof value === 'number' ? tidy(value) : value;
  };
  const whole = record => Object.fromEntries(Object.entries(record).filter(([name, value]) => name !== 'across' || Math.abs(value) > tiny)
    .map(([name, value]) => [name, typeof value === 'number' ? tidy(value) : value]));
  for (const [name, point] of Object.entries(sketch.points)) {
    const group = `linkage.points.${name}`, old = linkage.points?.[name], [u, v] = localIn(frames[point.link], point.at);
    if (!old) set[group] = whole(point.pin ? { link: point.link, distance_2: 0 } : point.link === 'ground' ? { x: u, y: v } : { link: point.link, along: u, across: v });
    else if (point.pin) continue;
    else if (old.distance_2 !== undefined) {
      const { inner } = sketch.dyads.find(dyad => dyad.links.includes(point.link));
      put(`${group}.distance_2`, distance(inner, point.at), old.distance_2);
      if (old.distance_1 !== undefined) put(`${group}.distance_1`, Math.hypot(u, v), old.distance_1);
      if (old.distance_1 !== undefined) put(`${group}.side`, v > 0 ? 'left' : 'right', old.side);
    } else for (const [field, value] of Object.entries(old.link ? { along: u, across: v } : { x: u, y: v })) put(`${group}.${field}`, value, old[field]);
  }
  for (const name of Object.keys(linkage.points || {})) if (!(name in sketch.points)) set[`linkage.points.${name}`] = null;
  for (const dyad of sketch.dyads) {
    const { name, kind, links, first, second, inner, direction } = dyad, old = dyads[name], was = before?.dyads.find(of => of.name === name);
    const p = placeOfEnd(sketch, first), q = placeOfEnd(sketch, second), all = { kind, first, second, links };
    let { mode } = dyad;
    if (kind === 'RRR') {
      const turn = (of, j) => cross(offset(placeOfEnd(of, first), j), offset(placeOfEnd(of, second), j));
      mode = was ? (turn(sketch, inner) * turn(before, was.inner) < 0 ? 3 - mode : mode) : turn(sketch, inner) > 0 ? 2 : 1;
      Object.assign(all, { length_1: distance(p, inner), length_2: distance(q, inner) });
    } else if (kind === 'RRP') {
      mode = dot(offset(p, inner), frameAt(p, direction).unit) > 0 ? 2 : 1;
      const turn = direction - frames[(sketch.points[second] || second).link].angle;
      Object.assign(all, { length_1: distance(p, inner), direction_2: old ? turn : angleOf(frameAt(p, turn).unit) });
    }
    all.mode = mode;
    if (typeof second !== 'string') {
      const [u, v] = localIn(frames[second.link], second.at);
      all.second = whole({ link: second.link, along: u, across: v });
      if (old) for (const [field, value] of [['along', u], ['across', v]]) put(`dyads.${name}.second.${field}`, value, old.second[field]);
    }
    if (!old) set[`dyads.${name}`] = whole(all);
    else for (const [field, value] of Object.entries(all)) if (typeof value !== 'object') put(`dyads.${name}.${field}`, value, field === 'mode' ? old.mode ?? 2 : old[field]);
  }
  for (const name of linkage.dyads || []) if (!sketch.dyads.some(dyad => dyad.name === name)) set[`dyads.${name}`] = null;
  const order = sketch.dyads.map(dyad => dyad.name);
  if (order.join() !== (linkage.dyads || []).join()) {
    set['linkage.dyads'] = order;           // with joints of which lists of one for each know nothing
    for (const path of ['joint_names', 'joint_states.ratios', 'joint_states.offsets']) if (leafOf(scene, path)) set[path] = null;
  }
  for (const { path, link, at } of sketch.riders) {
    const old = leafOf(scene, path) ?? {};
    if (!frames[link]) set[path.split('.').slice(0, 2).join('.')] = null;
    else localIn(frames[link], at).forEach((value, i) => put(`${path}.${['along', 'across'][i]}`, value, old[['along', 'across'][i]]));
    if (old.link && old.link !== link) set[`${path}.link`] = link;
  }
  if (sketch.drive === 'cylinder') put('cylinder.mode', cross(...cylinderEnds(sketch)) > 0 ? 2 : 1, scene.cylinder?.mode ?? 2);
  return Object.assign(set, crankOf(scene, written(scene, set)));
}

/** What of a crank that is a rod changes with its length or with the section and density of the rods. */
function crankOf(before, after) {
  const [was, body] = [before, after].map(({ linkage = {}, bodies = {}, cylinder = {} }) => {
    const { along = 0, across = 0 } = Object.values(linkage.points || {}).find(point => point.link === 'crank') || cylinder.pin || {};
    return bodies.rods && rodOf(bodies.rods, Math.hypot(along, across));
  }), { crank } = before.bodies || {}, isRod = was && body && crank && Math.abs(crank.mass - was.mass) < 1e-6 * was.mass;
  return Object.fromEntries(Object.entries(isRod ? body : {}).filter(([field, value]) => Math.abs(value - crank[field]) > 1e-9 * value).map(([field, value]) => [`bodies.crank.${field}`, tidy(value)]));
}

/** A sketch driven at another link on the ground, whose pins are all that joins links; RangeError if no dyads do it. */
export function drivenAt(sketch, link) {
  must(sketch.drive === 'crank' && sketch.dyads.every(dyad => dyad.kind === 'RRR'), 'Only the drive of a linkage of pins can be chosen: begin with New, then Slide or Cylinder for one that drives');
  const bodies = { crank: new Set() }, at = { O: [0, 0] }, owners = {};
  const join = (of, joint) => { (bodies[of] ||= new Set()).add(joint); };
  join('ground', 'O');
  join('crank', 'O');
  for (const [name, point] of Object.entries(sketch.points)) {
    owners[name] = point.pin ? `.${point.pin}` : point.link === 'ground' && !Math.hypot(...point.at) ? 'O' : name;
    at[owners[name]] = point.at;
    join(point.link, owners[name]);
  }
  for (const { name, links, first, second, inner } of sketch.dyads) {
    at[`.${name}`] = inner;
    [first, second].forEach((end, i) => { join(links[i], owners[end]); join(links[i], `.${name}`); });
  }
  const grounded = [...bodies[link]].filter(joint => bodies.ground.has(joint));
  if (link === 'crank' || link === 'ground' || grounded.length !== 1) throw new RangeError('The drive turns a link that is pinned to the ground');
  const rename = of => (of === link ? 'crank' : of === 'crank' ? link : of), origin = at[grounded[0]], moved = place => offset(origin, place);
  const made = newSketch('crank', 0), names = {}, solved = new Set(['ground', link]);
  const pointFor = joint => {
    const of = ['ground', link, ...solved].find(body => bodies[body].has(joint) && solved.has(body)), pin = made.dyads.find(dyad => dyad.joint === joint);
    names[joint] ||= joint[0] === '.' || joint === 'O' ? freshName({ ...sketch.points, ...made.points }) : joint;
    made.points[names[joint]] ||= { link: rename(of), at: moved(at[joint]), pin: pin && pin.links.includes(rename(of)) ? pin.name : null, isOnLine: false };
    return names[joint];
  };
  const isKnown = joint => [...solved].some(body => bodies[body].has(joint));
  for (let left = Object.keys(bodies).filter(body => !solved.has(body)); left.length;) {
    const hanging = left.filter(body => [...bodies[body]].filter(isKnown).length === 1);
    const pair = hanging.flatMap(one => hanging.filter(two => two > one).map(two => [one, two, [...bodies[one]].find(joint => bodies[two].has(joint) && !isKnown(joint))])).find(of => of[2]);
    if (!pair) throw new RangeError(`Driven there, ${left.map(rename).join(', ')} close only together: no dyads`);
    const [one, two, joint] = pair, ends = [one, two].map(body => pointFor([...bodies[body]].find(isKnown)));
    made.dyads.push({ name: `d${made.dyads.length + 1}`, kind: 'RRR', links: [rename(one), rename(two)], first: ends[0], second: ends[1], inner: moved(at[joint]), direction: null, mode: 2, joint });
    [one, two].forEach(body => solved.add(body));
    left = left.filter(body => !solved.has(body));
  }
  made.x = angleOf(drivenPin(made).at);
  made.frames.crank = frameAt([0, 0], made.x);
  made.riders = sketch.riders.map(rider => ({ ...rider, path: rider.path.startsWith('external.') ? `external.${rename(rider.link)}` : rider.path, link: rename(rider.link), at: moved(rider.at), pin: null, isOnLine: false }));
  return made;
}

/** Give the page its tools to draw: what `page` has is said in page.js. */
export function addDrawing(page) {
  const { store, say, refuse } = page;
  let draft = {};             // clicks that are no scene yet: drive, origin, pin of the driven link, ends [{name, pin, link, at}], guide
  let expected = {};          // {scene, pins: {dyad: place}} as drawn: a mode that shows a pin elsewhere is the other
  const scene = () => store.state.scene;
  /** A change of numbers, with what follows from it. */
  page.alsoChanged = set => ({ ...set, ...crankOf(scene(), written(scene(), set)) });
  const isEmpty = () => !Object.keys(scene()).length;
  const sketchNow = () => {
    const x = page.engine.inside(store.state.view.at);
    must(page.engine.at(x), 'There is no pose here: undo, or begin with New');
    return sketchOf(scene(), page.engine, x);
  };
  /** Whether there is a machine of which the server has answered all dyads. */
  const canSketch = () => page.engine && scene().linkage?.kind === 'machine' && (scene().linkage.dyads ?? []).every(name => page.structure().sketch.dyads.some(dyad => dyad.name === name));

  /** A handler that says what is wrong where it was drawn. */
  const guarded = act => (...given) => {
    try {
      return act(...given);
    } catch (error) {
      if (!(error instanceof RangeError)) throw error;
      if (Array.isArray(given[0])) label(given[0], error.message).classList.add('wrong');      // where it was drawn
      return refuse(error.message);
    }
  };

  // --- what is drawn above the picture ---
  const put = (tag, attributes, text) => draw(page.picture.over, tag, attributes, text);
  const clear = () => page.picture.over.replaceChildren();
  const line = (a, b, kind) => {
    const [[x1, y1], [x2, y2]] = [a, b].map(place => page.picture.pixels(place));
    put('line', { class: kind, x1, y1, x2, y2 });
  };
  const mark = (place, kind, r = 5, more = {}) => {
    const [cx, cy] = page.picture.pixels(place);
    return put('circle', { class: kind, cx, cy, r, ...more });
  };
  const label = (place, text) => {
    const [x, y] = page.picture.pixels(place), isLeft = x < 0.6 * page.picture.width;
    return put('text', { class: 'dimension', x, y, dx: isLeft ? 8 : -8, dy: -8, 'text-anchor': isLeft ? 'start' : 'end' }, text);
  };
  const inWords = metres => (metres < 1 ? `${Number((metres * 1000).toPrecision(4))} mm` : `${Number(metres.toPrecision(4))} m`);
  /** A length beside its link; a click or Enter on it asks for the number of the parameter `path`. */
  function dimension(a, b, path) {
    line(a, b, 'dimension');
    const words = inWords(distance(a, b)), middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
    if (!path) return label(middle, words);
    const [x, , , y] = page.picture.room.take(page.picture.pixels(middle), Math.PI / 2 - angleOf(offset(a, b)), 8 * words.length, 18);
    const text = put('text', { class: 'dimension', x, y: y - 4, tabindex: 0, role: 'button', 'data-length': path, 'aria-label': `${path}, ${words}: type another` }, words);
    const ask = event => {
      event.stopPropagation();
      event.preventDefault();
      const box = text.getBoundingClientRect(), field = html('input', { className: 'typed', 'aria-label': path, value: words, style: `position: fixed; left: ${box.left}px; top: ${box.top - 6}px; width: 7em` });
      document.body.append(field);
      field.select();
      const close = () => field.isConnected && setTimeout(() => field.remove());         // not within its own blur
      field.addEventListener('blur', close);
      field.addEventListener('keydown', guarded(key => {
        key.stopPropagation();
        if (key.key === 'Enter' && field.value !== words) store.dispatch({ set: page.alsoChanged({ [path]: page.numberOf(path, field.value, 'm', words.split(' ')[1]) }), typed: path });
        if (key.key === 'Enter' || key.key === 'Escape') close();
      }));
    };
    text.addEventListener('pointerdown', ask);
    text.addEventListener('keydown', key => { if (key.key === 'Enter') ask(key); });
  }

  // --- where the pointer is ---
  const size = () => page.picture.svg.clientWidth / page.picture.scale / 2;
  const snapped = place => {                              // three digits of the picture
    const step = 10 ** Math.floor(Math.log10(size() / 100));
    return place.map(value => tidy(step * Math.round(value / step)));
  };
  const isNear = (a, b) => distance(a, b) * page.picture.scale < NEAR_PIXELS;
  /** What is known at a place: {name} of a point, {pin} of a dyad, {rider}, {base}, or a link alone; or null. */
  function below(sketch, place) {
    const known = sketch.drive === 'slide' ? [] : [{ base: true, link: 'ground', at: [0, 0] }];
    for (const dyad of sketch.dyads) if (dyad.inner) known.push({ pin: dyad.name, link: dyad.links[dyad.kind === 'RRR' ? 1 : 0], at: dyad.inner });
    for (const dyad of sketch.dyads) if (typeof dyad.second !== 'string') known.push({ guide: dyad.name, link: dyad.second.link, at: dyad.second.at });
    for (const [name, point] of Object.entries(sketch.points)) if (!point.pin) known.push({ name, link: point.link, at: point.at });
    sketch.riders.forEach((rider, index) => { if (!rider.pin) known.push({ rider: index, link: rider.link, at: rider.at }); });
    const near = known.filter(of => isNear(of.at, place)).sort((one, two) => distance(one.at, place) - distance(two.at, place));
    // where they are in one place a pin is meant, and a guide last of all
    const best = near.filter(of => distance(of.at, near[0].at) * page.picture.scale < 3);
    if (near.length) return best.find(of => of.pin || of.name) || best.find(of => !of.guide) || best[0];
    for (const [link, a, b] of barsOf(sketch)) {
      const [u, v] = localIn(frameTo(a, b), place);
      if (u > 0 && u < distance(a, b) && Math.abs(v) * page.picture.scale < 14) return { link, isOnBar: true, at: placeIn(frameTo(a, b), [u, 0]) };
    }
    return null;
  }
  /** [link, place, place] of the straight parts of all links. */
  function barsOf(sketch) {
    const bars = [];
    for (const { kind, links, first, second, inner } of sketch.dyads) {
      const [p, q] = [first, second].map(end => placeOfEnd(sketch, end));
      if (inner) bars.push([links[0], p, inner]);
      if (kind !== 'RRP') bars.push([links[1], q, inner || p]);
    }
    for (const { link, at: place, pin } of pointsOf(sketch)) {
      const owner = sketch.dyads.find(dyad => dyad.links.includes(link));
      if (link === 'crank') bars.push([link, [0, 0], place]);
      if (owner?.inner && !pin) bars.push([link, owner.inner, place]);
    }
    return bars;
  }

  // --- changes ---
  /** Make a change that gives the scene of a sketch. */
  function dispatchDrawn(sketch, change) {
    store.dispatch({ ...change, view: { at: sketch.x } });
    expected = { scene: scene(), pins: Object.fromEntries(sketch.dyads.filter(dyad => dyad.inner).map(dyad => [dyad.name, dyad.inner])) };
  }
  function dispatchSketch(sketch, before, merge, held) {
    const set = changesOf(scene(), sketch, before, held);
    if (Object.keys(set).length) dispatchDrawn(sketch, { set, merge });
  }
  page.onStructure = () => {
    if (scene() !== expected.scene || !canSketch() || !page.engine.at(page.engine.inside(store.state.view.at))) return;
    const name = Object.keys(expected.pins).find(of => distance(page.engine.joint(`${of}_inner`), expected.pins[of]) > 0.01 * size());
    if (!name) return;
    delete expected.pins[name];                           // once: what is drawn may be impossible
    flip(name, `mode ${name}`);
    expected.scene = scene();
  };
  function flip(name, merge) {
    store.dispatch({ set: { [`dyads.${name}.mode`]: 3 - (scene().dyads[name].mode ?? 2) }, merge });
  }
  /** Make the scene a machine, which alone can be drawn on. */
  function becomeMachine() {
    if (isEmpty() || scene().linkage?.kind === 'machine') return;
    const machine = machineOf(scene());
    if (machine) store.dispatch({ scene: machine });
    else refuse('This kind cannot be drawn on: begin with New');
  }
  function addTool(tool) {
    const acts = Object.entries(tool).filter(([, of]) => typeof of === 'function');
    page.addTool({ ...tool, ...Object.fromEntries(acts.map(([name, act]) => [name, guarded(act)])), begin: guarded(() => (becomeMachine(), tool.begin?.())), end: clear, isDrawing: true, get hint() { return tool.hintNow?.() ?? tool.title; } });
  }

  // --- two rods, a slide, a cylinder ---
  const fromOrigin = place => (isEmpty() && draft.origin ? offset(draft.origin, place) : place);
  const onPicture = place => (isEmpty() && draft.origin ? [place[0] + draft.origin[0], place[1] + draft.origin[1]] : place);
  function hintOf(kind) {
    const { drive, origin, pin, ends = [] } = draft;
    if (isEmpty() && !origin) return { RRR: 'Click the ground pivot of the crank', RRP: 'Click the block that drives, on a level guide (Rods begins with a crank)', RPR: 'Click the ground pivot of the link that the cylinder drives (Rods begins with a crank)' }[kind];
    if (isEmpty() && !pin) return drive === 'cylinder' ? 'Click the pin of the cylinder on that link' : 'Click the pin of the crank';
    if (isEmpty() && drive === 'cylinder') return 'Click the pivot of the cylinder on the ground';
    if (!ends.length) return 'Begin on a joint or on a link';
    if (ends.length === 1 && kind === 'RRP') return 'Click the pin of the block; drag to turn its guide';
    if (ends.length === 1 && kind === 'RRR') return 'Click the pin between the two new links';
    return 'Click the other end: a joint, a link, or empty space for a ground pivot';
  }
  function showDraft(kind, pointer) {
    clear();
    const { drive, origin, pin, ends = [], guide } = draft, chain = ends.map(end => onPicture(end.at));
    if (isEmpty() && origin && drive === 'slide') line(...[-0.3, 0.3].map(part => placeIn(frameAt(origin, 0), [part * size(), 0])), 'draft guide');
    else if (isEmpty() && origin) mark(origin, 'draft pivot', 7);
    if (isEmpty() && pin) line(origin, onPicture(pin), 'draft bar');
    chain.forEach((at, i) => { mark(at, 'draft'); if (i) line(chain[i - 1], at, 'draft bar'); });
    if (guide && pointer) line(...[-0.3, 0.3].map(part => placeIn(frameAt(onPicture(guide), guideAngle(pointer)), [part * size(), 0])), 'draft guide');
    else if (pointer && (chain.length || isEmpty() && origin)) dimension(chain.at(-1) || origin, pointer);
    if (!pointer) say(hintOf(kind));
  }
  /** The scene of the first dyad, which follows from the clicks alone; a sketch of later ones is that of the picture. */
  function drawnSketch() {
    if (!isEmpty()) return sketchNow();
    const { drive, pin } = draft, made = newSketch(drive, drive === 'crank' ? angleOf(pin) : 0);
    made.frames[made.driven] = frameTo([0, 0], pin);
    made.points.A = { link: made.driven, at: pin };
    return made;
  }
  function click(kind, place) {
    const beginAt = pin => Object.assign(draft, { pin, ends: [{ name: 'A', link: DRIVEN[draft.drive], at: pin }] });
    if (isEmpty() && !draft.origin) {
      draft = { drive: FIRST[kind], origin: place };
      if (kind === 'RRP') beginAt([0, 0]);
    } else if (isEmpty() && !draft.pin) {
      const pin = fromOrigin(place);
      must(!isNear(pin, [0, 0]), 'The crank needs a length');
      beginAt(placeIn(frameTo([0, 0], pin), [threeDigits(Math.hypot(...pin)), 0]));
    } else if (isEmpty() && draft.drive === 'cylinder') {
      const sketch = drawnSketch(), base = snapped(fromOrigin(place));
      must(!isNear(base, [0, 0]) && !isNear(base, draft.pin), 'The cylinder needs a pivot of its own on the ground');
      sketch.points = {};             // the cylinder alone hangs on the pin
      sketch.riders = [{ path: 'cylinder.base', link: 'ground', at: base }, { path: 'cylinder.pin', link: 'crank', at: draft.pin }];
      begin(sketch);
    } else {
      if (!isEmpty() && !canSketch()) throw new RangeError('What is there cannot move: undo, or begin with New');
      place = fromOrigin(place);
      const ends = draft.ends ||= [], known = below(drawnSketch(), place);
      if (!ends.length && !known) throw new RangeError('Begin on a joint or on a link: on what is known already');
      if (!ends.length) ends.push(known);
      else if (ends.length === 1 && kind !== 'RPR') {
        if (known && !known.isOnBar) throw new RangeError('The pin between two new links is free: click beside what is there');
        ends.push({ at: kind === 'RRP' ? snapped(place) : place });
        draft.guide = kind === 'RRP' ? ends[1].at : null;
      } else finish(kind, ends[0], ends.length > 1 ? ends[1].at : null, known || { link: 'ground', at: snapped(place) });
    }
  }
  function finish(kind, first, inner, second) {
    if (kind !== 'RRP' && second.link === first.link) throw new RangeError(second.link === 'ground' ? 'Both ends are on the ground: nothing would move' : 'Both ends are on one link: it would be one rigid body');
    const isFirst = isEmpty(), sketch = drawnSketch(), before = isFirst ? null : structuredClone(sketch);
    const known = ['crank', 'ground', ...sketch.dyads.flatMap(dyad => [dyad.name, ...dyad.links])];
    const fresh = (letter, count) => Array.from({ length: 99 }, (_, i) => `${letter}${i + 1}`).filter(name => !known.includes(name)).slice(0, count);
    const [name] = fresh('d', 1), links = fresh('l', 2);
    // as in the picture, whose pins without a name have the letters between
    const letters = Object.fromEntries(isFirst ? [] : Object.values(page.structure().sketch.letters).map(letter => [letter, true]));
    const pointFor = ({ name: named, pin, link, at }) => {
      const same = named || Object.keys(sketch.points).find(of => (pin ? sketch.points[of].pin === pin : sketch.points[of].link === link && distance(sketch.points[of].at, at) === 0));
      if (same) return same;
      const taken = { ...sketch.points, ...scene().linkage?.points }, { joints = {}, letters: shown } = isFirst ? {} : page.structure().sketch;
      const letter = Object.keys(joints).filter(joint => distance(page.engine.joint(joint), at) < 1e-9 * size()).map(joint => shown[joint])[0];
      const made = /^[A-Z]$/.test(letter) && !(letter in taken) ? letter : freshName({ ...taken, ...letters });
      sketch.points[made] = { link, at, pin };
      return made;
    };
    const start = pointFor(first);
    if (inner) letters[freshName({ ...sketch.points, ...letters })] = true;
    sketch.dyads.push({ name, kind, links, first: start, second: kind === 'RRP' ? { link: 'ground', at: inner } : pointFor(second),
      inner, direction: kind === 'RRP' ? second.direction : null, mode: 2 });
    if (isFirst) return begin(sketch);
    draft = {};
    dispatchSketch(sketch, before);
  }
  /** The scene of what was drawn first. */
  function begin(sketch) {
    const { drive, pin, origin } = draft, { view } = page.picture, made = changesOf({}, sketch);
    draft = {};
    Object.assign(view, { x: view.x - origin[0], y: view.y - origin[1] });
    dispatchDrawn(sketch, { scene: written({
      linkage: { kind: 'machine', input: drive }, bodies: { rods: NEW_RODS, ...(drive !== 'slide' && { crank: rodOf(NEW_RODS, Math.hypot(...pin)) }) },
      drive: drive === 'crank' ? { source: 'timer', speed: 10.0 } : { source: 'motion', speed: 0.1 },
      outputs: ['state', 'output', 'joint_states', 'loads', 'links', 'reactions'] }, made) });
  }
  const guideAngle = place => (isNear(onPicture(draft.guide), place) ? 0 : Math.PI / 12 * Math.round(frameTo(onPicture(draft.guide), place).angle / (Math.PI / 12)));
  for (const [name, label_, kind, title] of [
    ['rods', 'Rods', 'RRR', 'Two links: from what is known, with a free pin, to what is known or to a new ground pivot'],
    ['slide', 'Slide', 'RRP', 'A rod and a block that slides on the ground'],
    ['cylinder', 'Cylinder', 'RPR', 'A telescope between two points']]) {
    addTool({
      name, label: label_, title, hintNow: () => hintOf(kind),
      begin: () => showDraft(kind),
      redraw: () => (draft.origin || draft.ends) && showDraft(kind),
      down: place => (click(kind, place), showDraft(kind)),
      move: place => showDraft(kind, place),
      up(place) {
        if (!draft.guide) return;
        const direction = guideAngle(place), [first, pin] = draft.ends;
        finish('RRP', first, pin.at, { direction });
        showDraft(kind);
      },
      key: event => event.key === 'Escape' && (draft = {}, showDraft(kind), true),
    });
  }

  // --- shape: drag what is there ---
  let grabbed = null, drags = 0;
  const turnBetween = (u, v) => Math.atan2(cross(u, v), dot(u, v));
  /** Move what a hand holds; return the point that it holds. */
  function moveTo(sketch, { base, guide, pin, name, rider, at: from }, place, keepsLength, before) {
    const hold = centre => placeIn(frameTo(centre, place), [distance(centre, from), 0]);
    const held = pin ? sketch.dyads.find(dyad => dyad.name === pin) : guide ? sketch.dyads.find(dyad => dyad.name === guide).second : rider !== undefined ? sketch.riders[rider] : sketch.points[name];
    if (base) {                             // the origin moves: all else stays where it is
      const shift = snapped(place), moved = [...pointsOf(sketch), ...sketch.dyads.map(dyad => dyad.second).filter(of => typeof of !== 'string')];
      for (const of of moved) of.at = offset(shift, of.at);
      for (const dyad of sketch.dyads) if (dyad.inner) dyad.inner = offset(shift, dyad.inner);
    } else if (pin) held.inner = keepsLength ? hold(placeOfEnd(sketch, held.first)) : held.kind === 'RRP' ? snapped(place) : place;
    else {
      const neighbour = sketch.dyads.find(dyad => dyad.second === name && dyad.inner) || sketch.dyads.find(dyad => dyad.first === name && dyad.inner);
      held.at = keepsLength && held.link === 'crank' ? hold([0, 0]) : keepsLength && neighbour ? hold(neighbour.inner)
        : held.link === 'crank' && name ? placeIn(frameTo([0, 0], place), [threeDigits(Math.hypot(...place)), 0]) : snapped(place);
      if (name && held.isOnLine && held.link !== 'crank' && sketch.dyads.some(dyad => dyad.links.includes(held.link))) {
        const frame = before.frames[held.link], [u, v] = localIn(frame, held.at);      // near its line it stays there
        if (Math.abs(v) * page.picture.scale < 8) held.at = placeIn(frame, [threeDigits(u), 0]);
      }
    }
    const driven = pointsOf(sketch).filter(point => point.link === sketch.driven);
    if (held?.link === 'slider') {          // along its guide, with all that is on it
      sketch.x = before.x + held.at[0] - from[0];
      sketch.frames.slider = frameAt([sketch.x, 0], 0);
      held.at = from;
      for (const point of driven) point.at = [point.at[0] + sketch.x - before.x, point.at[1]];
    } else if (base || held === drivenPin(sketch)) {
      const turn = turnBetween(drivenPin(before).at, drivenPin(sketch).at);
      sketch.x = before.x + turn;
      sketch.frames.crank = frameAt([0, 0], before.frames.crank.angle + turn);
      for (const point of driven) if (held && distance(point.at, from) < 1e-9 * size()) point.at = held.at;
    }
    return held;
  }
  addTool({
    name: 'shape', label: 'Shape', title: 'Drag a pivot, a pin, a guide or a point: lengths follow. Shift keeps a length; click a length to type it',
    redraw: showLengths,
    down(place) {
      if (!canSketch()) return;
      const before = sketchNow(), handle = below(before, place);
      if (handle && !handle.isOnBar) grabbed = { before, handle, word: `shape ${drags += 1}` };
    },
    move(place, event) {
      if (!grabbed) return;
      const { before, handle, word } = grabbed, sketch = structuredClone(before);
      const held = moveTo(sketch, handle, place, event.shiftKey, before);
      dispatchSketch(sketch, before, word, held);
    },
    up() { grabbed = null; },
  });
  function showLengths() {
    clear();
    if (!canSketch()) return;
    const sketch = sketchNow();
    for (const [name, { along, across, link }] of Object.entries(scene().linkage.points || {})) if (link === 'crank' && along && !across) dimension([0, 0], sketch.points[name].at, `linkage.points.${name}.along`);
    for (const { name, kind, first, second, inner } of sketch.dyads) {
      if (inner) dimension(placeOfEnd(sketch, first), inner, `dyads.${name}.length_1`);
      if (kind === 'RRR') dimension(placeOfEnd(sketch, second), inner, `dyads.${name}.length_2`);
    }
  }

  // --- points, springs, forces: pressed on a link, let go elsewhere ---
  const freshIn = (family, letter) => Array.from({ length: 99 }, (_, i) => `${letter}${i + 1}`).find(name => !(name in (scene()[family] || {})));
  const localPlace = (sketch, { link, at }) => {
    const [along, across] = localIn(sketch.frames[link], at).map(tidy);
    return { link, along, ...(Math.abs(across) > 1e-9 * size() ? { across } : {}) };
  };
  function addPressTool(name, label_, title, show, done) {
    let press = null;
    addTool({
      name, label: label_, title,
      down(place) {
        if (!canSketch()) throw new RangeError('Draw a linkage first');
        const sketch = sketchNow();
        press = { sketch, start: below(sketch, place) || { link: 'ground', at: snapped(place) } };
      },
      move(place) {
        clear();
        if (press) show(press.start, place);
      },
      up(place) {
        const { sketch, start } = press || {};
        press = null;
        clear();
        if (sketch) store.dispatch({ set: done(sketch, start, place, isNear(start.at, place)) });
      },
    });
  }
  addPressTool('point', 'Point', 'A third point on a link: click the link, or press on it and drag the point beside it', (start, place) => dimension(start.at, place), (sketch, start, place, isClick) => {
    must(start.link !== 'ground', 'A point is on a link that moves');
    return { [`points.${freshIn('points', 'P')}`]: localPlace(sketch, { link: start.link, at: isClick ? start.at : snapped(place) }) };
  });
  addPressTool('spring', 'Spring', 'Press on one end of the spring, a joint, a link or the ground, and let go on the other', (start, place) => dimension(start.at, place), (sketch, start, place) => {
    const end = below(sketch, place) || { link: 'ground', at: snapped(place) };
    must(end.link !== start.link, 'The ends of a spring are on two links');
    return { [`springs.${freshIn('springs', 's')}`]: { first: localPlace(sketch, start), second: localPlace(sketch, end), stiffness: NEW_SPRING, free_length: threeDigits(distance(start.at, end.at)) } };
  });
  const forceOf = (start, place) => offset(start.at, place).map(value => Number((NEW_FORCE * value / size()).toPrecision(2)));
  addPressTool('force', 'Force', 'Press on a link where the force acts, and drag the arrow', (start, place) => {
    line(start.at, place, 'draft force');
    label(place, `${Number(Math.hypot(...forceOf(start, place)).toPrecision(3))} N`);
  }, (sketch, start, place, isClick) => {
    must(start.link !== 'ground', 'A force acts on a link that moves');
    must(!isClick, 'Drag the arrow away from its point');
    const [force_x, force_y] = forceOf(start, place), { along, across = 0 } = localPlace(sketch, start);
    return { [`external.${start.link}`]: { ...scene().external?.[start.link], force_x, force_y, along, across } };
  });

  // --- modes, drive, what goes ---
  /** [dyad, where its pin would be in the other mode]. */
  const mirrors = sketch => sketch.dyads.filter(dyad => dyad.inner).map(dyad => {
    const p = placeOfEnd(sketch, dyad.first), chord = dyad.kind === 'RRR' ? frameTo(p, placeOfEnd(sketch, dyad.second)) : frameAt(p, dyad.direction + Math.PI / 2);
    const [u, v] = localIn(chord, dyad.inner);
    return [dyad, placeIn(chord, [u, -v])];
  });
  function showMirrors() {
    clear();
    if (!canSketch()) return;
    const sketch = sketchNow();
    const places = mirrors(sketch).map(([, place]) => place);
    if (!page.picture.view.isChosen && !page.picture.shows(places)) {
      page.fit(false, places);
      return store.dispatch({ view: { layers: { ...store.state.view.layers } } });             // draws all again
    }
    for (const [dyad, place] of mirrors(sketch)) {
      line(placeOfEnd(sketch, dyad.first), place, 'mirror');
      if (dyad.kind === 'RRR') line(placeOfEnd(sketch, dyad.second), place, 'mirror');
      const grip = mark(place, 'mirror', 9, { tabindex: 0, role: 'button', 'data-mirror': dyad.name, 'aria-label': `other mode of ${dyad.name}` });
      grip.addEventListener('keydown', event => { if (event.key === 'Enter') flip(dyad.name); });
    }
  }
  addTool({
    name: 'flip', label: 'Flip', title: 'Click the pale mirror pose of a pair of links: their other mode',
    redraw: showMirrors,
    down(place) {
      const of = canSketch() && mirrors(sketchNow()).find(([, at]) => isNear(at, place));
      if (of) flip(of[0].name);
    },
  });
  addTool({
    name: 'drive', label: 'Drive', title: 'Click a link on the ground that is to turn: it becomes the crank',
    down(place) {
      if (!canSketch()) return;
      const before = scene(), { bodies = {} } = before, named = ['torsion_springs', 'forces', 'friction'].find(name => Object.keys(before[name] ?? {}).length);
      must(!named, `${named} name links, joints or the crank's angle: choose the drive in the file`);
      must(Object.keys(bodies).every(name => name === 'rods' || name === 'crank'), 'Links with masses of their own: choose the drive in the file');
      const now = sketchNow(), link = below(now, place)?.link, sketch = drivenAt(now, link), crank = bodies.rods && { crank: rodOf(bodies.rods, Math.hypot(...drivenPin(sketch).at)) };
      const external = Object.fromEntries(Object.entries(before.external ?? {}).map(([of, load]) => [{ crank: link, [link]: 'crank' }[of] ?? of, load]));
      let made = { ...before, linkage: { kind: 'machine' }, dyads: {}, bodies: { ...bodies, ...crank }, external };
      made = written(made, changesOf(made, sketch));
      dispatchDrawn(sketch, { scene: made });
    },
  });
  addTool({
    name: 'delete', label: 'Delete', title: 'Click what is to go: a pair of links, a point, a spring or a force',
    down(place, event, hit) {
      if (!canSketch()) return;
      if (hit?.spring) return store.dispatch({ set: { [`springs.${hit.spring}`]: null } });
      const before = sketchNow(), sketch = structuredClone(before), of = below(before, place);
      if (of?.rider !== undefined && !before.riders[of.rider].path.startsWith('cylinder.')) return store.dispatch({ set: { [before.riders[of.rider].path.split('.').slice(0, 2).join('.')]: null } });
      const owner = of && sketch.dyads.find(dyad => [of.pin, of.guide].includes(dyad.name) || dyad.links.includes(of.link) || (of.name && of.name === dyad.second));
      must(owner, 'Click a pair of links; the crank stays: New begins again');
      const gone = [owner];                               // and all that hangs on it
      for (const dyad of sketch.dyads) if (!gone.includes(dyad) && [dyad.first, dyad.second].some(end => gone.some(({ links }) => links.includes((sketch.points[end] || end).link)))) gone.push(dyad);
      sketch.dyads = sketch.dyads.filter(dyad => !gone.includes(dyad));
      if (!sketch.dyads.length && sketch.drive !== 'cylinder') return startAgain();
      for (const name of Object.keys(sketch.points)) if (!sketch.dyads.some(dyad => [dyad.first, dyad.second].includes(name))) delete sketch.points[name];
      const links = gone.flatMap(dyad => dyad.links), { bodies = {}, linkage } = scene();
      for (const link of links) delete sketch.frames[link];
      const set = changesOf(scene(), sketch, before);
      for (const link of links) if (bodies[link]) set[`bodies.${link}`] = null;
      if (links.includes(linkage.output)) set['linkage.output'] = null;
      store.dispatch({ set });
      say(`Without ${gone.map(dyad => dyad.name).join(', ')}`);
    },
  });
  function startAgain() {
    [draft, expected] = [{}, {}];
    store.dispatch({ scene: {}, view: { curves: null } });
    page.useTool('rods');
  }
  page.addButton('new', 'New', 'Begin with nothing', startAgain);
  page.addButton('weight', 'Weight', 'Weight on or off', () => {
    const has = Boolean(scene().gravity?.y);
    if (!isEmpty()) store.dispatch({ set: { 'gravity.y': has ? null : -9.80665 } });
    say(has ? 'Weight is left out' : 'Weight: 9.81 m/s^2 down');
  });
}
