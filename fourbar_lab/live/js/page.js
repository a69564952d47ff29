// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// The page: one state with undo and an address, the questions to the server, play, tools, files.
import { Engine, forcesOf, largestForces } from "./engine.js";
import { draw, Picture, significant } from "./picture.js";
import { Curves, drawPolygon, shownName, shownUnit } from "./curves.js";
import { html, numberField, numberOf, Panel, tickBox } from "./panel.js";
import { addDrawing } from "./draw.js";
const MOST_ADDRESS = 100000, SOON = 150, LATER = 500;      // [characters], [ms]
const WAYS = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const SAMPLED = "The largest and the least of the samples of each curve: a peak between two can be missed. Where samples beside each other differ much none is given.";
const WORDS = /^(?!(?:true|false|yes|no|on|off|null|y|n|nan|inf|infinity)$)[A-Za-z_]\w*$/i;

// --- scenes: nested parameters ---
export const leafOf = (scene, path) => path.split(".").reduce((tree, key) => tree?.[key], scene);
export function flatten(tree, prefix = "", flat = {}) {
  for (const [key, value] of Object.entries(tree)) {
    if (value !== null && typeof value === "object" && !Array.isArray(value)) flatten(value, `${prefix}${key}.`, flat);
    else flat[prefix + key] = value;
  }
  return flat;
}
/** A copy of a scene with another value or subtree at a path; null takes it away. */
export function withLeaf(scene, path, value) {
  const [key, ...rest] = path.split("."), copy = { ...scene };
  if (["__proto__", "constructor", "prototype"].includes(key)) return copy;
  if (rest.length) {
    const below = scene[key];
    copy[key] = withLeaf(below && typeof below === "object" ? below : {}, rest.join("."), value);
    if (!Object.keys(copy[key]).length) delete copy[key];
  } else if (value === null) delete copy[key];
  else copy[key] = value;
  return copy;
}
/** The scene as the text of a parameter file; integers: last words of the names that are whole numbers. */
export function yamlOf(scene, integers) {
  const written = (value, key) => {
    if (Array.isArray(value)) return `[${value.map(item => written(item, key)).join(", ")}]`;
    if (typeof value === "number") return Number.isInteger(value) && !integers.includes(key) ? (Math.abs(value) < 1e21 ? `${value}.0` : `${value}`.replace("e", ".0e")) : String(value);
    return typeof value === "boolean" || WORDS.test(value) ? String(value) : JSON.stringify(value);
  };
  const lines = (tree, indent) => Object.entries(tree).flatMap(([key, value]) => (value !== null && typeof value === "object" && !Array.isArray(value)
    ? [`${indent}${written(key)}:`, ...lines(value, `${indent}  `)] : [`${indent}${written(key)}: ${written(value, key)}`]));
  return ["/**:", "  ros__parameters:", ...lines(scene, "    "), ""].join("\n");
}

/** The state {scene, view} with undo: the only way to change it is dispatch(). */
export class Store {
  constructor(scene, view) {
    Object.assign(this, { state: { scene, view }, past: [], future: [], heard: [] });
  }
  subscribe(listener) { this.heard.push(listener); }
  change(state) {
    const before = this.state;
    this.state = state;
    for (const listener of this.heard) listener(state, before);
  }
  dispatch({ set = {}, scene = null, view = {}, merge = null, typed = null }) {
    const { state } = this;
    let next = scene ?? state.scene;
    for (const [path, value] of Object.entries(set)) if (leafOf(next, path) !== value) next = withLeaf(next, path, value);
    if (next !== state.scene) {
      if (!(merge && merge === this.past.at(-1)?.merge)) this.past.push({ scene: state.scene, merge, typed });
      this.future = [];
    }
    this.change({ scene: next, view: { ...state.view, ...("at" in view && { moment: null }), ...view } });
  }
  /** Begin a new entry of undo at the next change, though it merges with the one before by its word. */
  seal() { if (this.past.length) this.past.at(-1).merge = null; }
  undo() { this.step(this.past, this.future); }
  redo() { this.step(this.future, this.past); }
  step(from, to) {
    const entry = from.pop();
    if (!entry) return;
    to.push({ scene: this.state.scene, merge: null, typed: entry.typed });
    this.change({ ...this.state, scene: entry.scene });
  }
}

/** What an address changes in a scene and a view; RangeError of one that is too long or no address of ours. */
function readAddress(hash, base) {
  if (hash.length > MOST_ADDRESS) throw new RangeError(`the address has ${hash.length} characters, at most ${MOST_ADDRESS} are read`);
  let scene = base;
  const view = {}, flat = flatten(base);
  for (const [name, text] of new URLSearchParams(hash.slice(1))) {
    if (name === "at" || name === "acceleration") {
      view[name] = Number(text);
      if (!Number.isFinite(view[name])) throw new RangeError(`${name} = ${text}: must be a finite number`);
    } else if (name === "curves") view.curves = text.split(",").filter(Boolean);
    else if (name === "from" && text === "nothing") scene = {};
    else {
      let value = text;
      try { value = JSON.parse(text); } catch { /* a word */ }
      if (text !== "" && typeof value !== "number" && (typeof flat[name] === "number" || /^[-+.\d]/.test(text))) throw new RangeError(`${name} = '${text}': must be a number`);
      scene = withLeaf(scene, name, text === "" ? null : value);
    }
  }
  return { scene, view };
}
/** The address of a state; without a base the scene was drawn from nothing. */
function addressOf({ scene, view }, base, factor) {
  const query = new URLSearchParams(base ? {} : { from: "nothing" }), [flat, first] = [flatten(scene), flatten(base ?? {})];
  query.set("at", String(Number((view.at * factor).toPrecision(9))));
  if (view.acceleration) query.set("acceleration", view.acceleration);
  if (view.curves) query.set("curves", view.curves.join(","));
  for (const name of new Set([...Object.keys(flat), ...Object.keys(first)])) {
    if (JSON.stringify(flat[name]) !== JSON.stringify(first[name])) query.set(name, name in flat ? (typeof flat[name] === "string" && WORDS.test(flat[name]) ? flat[name] : JSON.stringify(flat[name])) : "");
  }
  return `#${query}`;
}
const moduleOf = text => {
  const url = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
  return import(url).finally(() => URL.revokeObjectURL(url));
};
const whenIdle = (act, limit) => (globalThis.requestIdleCallback ?? setTimeout)(act, limit);
/** Write a text where it is another one: the browser measures lines again. */
const tell = (element, words) => element.textContent === words || (element.textContent = words);
function later(wait, act) {
  let timer;
  return () => (clearTimeout(timer), (timer = setTimeout(act, wait)));
}

/** Start the page on the data that stand in it. */
export async function start(data, source) {
  const find = name => document.getElementById(name), page = { canAsk: data.canAsk, tools: {} }, svg = find("picture");
  let { structure } = data, module = structure.module && (await moduleOf(structure.module)), made = null;
  let problem = "", notice = "", refusal = "";      // what is wrong with the scene, with the address, with what was typed or clicked last
  /** The input for people: its unit and the factor to it. */
  const inputUnit = () => shownUnit(structure.input.unit), factorOf = () => inputUnit()[1];
  const withUnit = data.withUnit;         // {parameter: value that was given with its unit}: the server doubts no meaning of it
  /** Ask the server about the scene that is shown. */
  page.ask = async (question, asked) => {
    const { scene } = store.state, body = { scene, withUnit: Object.keys(withUnit).filter(name => JSON.stringify(leafOf(scene, name)) === JSON.stringify(withUnit[name])), ...asked };
    const answer = await fetch(`/${question}`, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) }).catch(() => null);
    if (!answer) return { problem: "fourbar live does not answer any more: start it again" };
    return answer.ok ? answer.json() : { problem: await answer.text() };
  };
  page.numberOf = (name, text, ...units) => {
    try {
      const { value, hasUnit } = numberOf(text, units[0], data.units, units[1]);
      if (hasUnit) withUnit[name] = value;
      else delete withUnit[name];
      return value;
    } catch (error) { throw new RangeError(`${name} = '${text}': ${error.message}`); }
  };
  page.say = words => tell(find("said"), words);
  page.refuse = words => {
    const alarm = (refusal = words) || problem || notice;
    tell(find("alarm"), alarm);
    if (alarm) page.say("");
  };

  let first = { scene: data.scene, view: {} };
  try { first = readAddress(location.hash, data.scene); } catch (error) { notice = error.message; }
  const view = { curves: null, layers: {}, tool: "pose", pace: 6, acceleration: 0, moment: null, ...first.view };
  view.at = "at" in first.view ? first.view.at / factorOf() : structure.start;
  const store = (page.store = new Store(first.scene, view));

  const isNothing = scene => !Object.keys(scene).length, isBegun = isNothing(data.scene) || /[#&]from=nothing/.test(location.hash);
  /** Whether the scene was drawn from nothing, so that it is not the one the page came with. */
  const isDrawing = () => isBegun || [store.state, ...store.past].some(entry => isNothing(entry.scene));
  const nameNow = () => (isDrawing() ? "drawing" : data.name);
  const showName = () => {
    tell(find("title"), nameNow());
    tell(document.querySelector("title"), `${nameNow()} - fourbar live`);
  };

  // --- structure and engine ---
  const chosenCurves = view => (view.curves ?? structure.usual).filter(name => name in structure.quantities);
  const valueOf = (scene, name) => leafOf(scene, name) ?? structure.values[name];
  /** What of a scene no parameter of the module covers: another of it is another structure. */
  const restOf = scene => JSON.stringify(Object.entries(flatten(scene)).filter(([name]) => !(name in module.parameters) && name !== "drive.speed").sort());
  const isOther = (scene, of) => restOf(scene) !== restOf(of) || Object.keys(module.parameters).some(name => (leafOf(scene, name) === undefined) !== (leafOf(of, name) === undefined) && structure.values[name] !== (leafOf(scene, name) ?? NaN));
  page.structure = () => structure;
  page.isAsWritten = () => store.state.scene === data.scene;
  const isOtherNow = scene => JSON.stringify(scene) !== JSON.stringify(store.state.scene);
  /** Say of the scene why it cannot be, with the number that was typed last; "" of one that can. */
  const fail = why => {
    const name = store.past.at(-1)?.typed, unit = structure.fields.find(field => field.name === name)?.unit ?? "";
    problem = why && name && !why.includes(name) ? `${name} = ${leafOf(store.state.scene, name) ?? "none"} ${unit}: ${why}` : why;
    for (const shown of [svg, find("curves"), panel.extrema, panel.values]) shown.classList.toggle("stale", Boolean(problem));
    page.refuse(refusal);
    return problem;
  };
  const askStructure = async () => {
    const { scene } = store.state;
    if (isNothing(scene)) return;              // begun anew before its time came
    const answer = await page.ask("structure", { known: structure.key });
    if (isOtherNow(scene) || fail(answer.problem ?? "")) return;
    const known = module && answer.key === structure.key ? module : await moduleOf(answer.module);
    if (isOtherNow(scene)) return;             // an answer that is late
    [structure, module, made] = [{ module: structure.module, ...answer }, known, scene];
    build(store.state, !page.engine || !pointer);
    page.onStructure?.(structure);
  };
  const withNumbers = answer => ({ ...answer, extrema: answer?.extrema?.map(one => ({ ...one, value: Number(one.value) })) });      // "Infinity" is no JSON
  let answered = { ...withNumbers(data.extrema), scene: data.scene, acceleration: 0 };        // the extrema that are known: {quantities, extrema, proof} of a scene at an acceleration
  const wanted = view => [...new Set([...chosenCurves(view), ...forcesOf(structure)])];
  const isAnswered = ({ scene, view }) => answered.extrema && scene === answered.scene && view.acceleration === answered.acceleration && wanted(view).every(name => answered.quantities?.includes(name));
  const askSoon = later(SOON, askStructure), askExtremaSoon = later(LATER, async () => {
    const { scene, view: { acceleration } } = store.state;
    if (isNothing(scene)) return;
    const answer = await page.ask("extrema", { quantities: wanted(store.state.view), acceleration });
    if (isOtherNow(scene)) return;             // an answer that is late
    if (answer.problem) return page.say(answer.problem);
    answered = { ...withNumbers(answer), scene, acceleration };
    if (isAnswered(store.state)) drawRest();
  });

  // --- draw ---
  const picture = (page.picture = new Picture(svg)), curves = new Curves(find("curves"), at => page.go(at));
  const panel = (page.panel = new Panel(find("panel"), page));
  const [inputField, inputWords] = numberField("input value", structure.input.unit, 0, page, at => page.go(at), inputUnit()[0]);
  find("at").after(inputField, inputWords);
  // in pale: a second scene, or this one as it was written
  const pale = data.second ?? (data.structure.module && Object.keys(data.scene).length ? data.structure : null), paleModule = pale && (await moduleOf(pale.module));
  let paleEngine = null;
  const secondOf = ({ layers, acceleration }) => {
    if (!(layers.second ?? Boolean(data.second)) || pale?.input.unit !== structure.input.unit) return null;      // one input moves both
    if (paleEngine?.acceleration !== acceleration) paleEngine = new Engine(pale, paleModule, pale.values, acceleration);
    return paleEngine;
  };
  let hasTurned = false;
  /** Where a crank turns that turned fully before, and the dyad that is stretched there. */
  const whereItTurns = engine => {
    hasTurned ||= engine.turnsFully;
    if (!hasTurned || engine.turnsFully || !engine.isAngle) return [];
    const shown = input => significant(input * factorOf()), flat = structure.sketch.dyads.flatMap(({ name, kind, links }) => {
      const bends = engine.ranges.flat().map(end => (engine.at(engine.inside(end)), links.map(link => engine.frame(link)))).map(([[, , a, b], [, , c, s]]) => Math.abs(kind === "RRR" ? a * s - b * c : a * c + b * s));
      return ["RRR", "RRP"].includes(kind) && Math.min(...bends) < 0.02 ? [name] : [];
    });
    return [`the crank turns only from ${engine.ranges.map(([low, high]) => `${shown(low)} to ${shown(high)}`).join(" and ")} deg${flat.length ? `: ${flat.join(", ")} cannot close beyond` : ""}`];
  };
  /** Make the engine of a state; the picture keeps its scale while something is dragged. */
  const build = (state, isFitted) => {
    const values = Object.fromEntries([...Object.keys(module.parameters), "drive.speed"].map(name => [name, valueOf(state.scene, name)]));
    try {
      const engine = new Engine(structure, module, values, state.view.acceleration, page.engine?.x);
      if (engine.ranges.length) page.engine = engine;
      else fail("with these lengths it closes nowhere near this pose");
    } catch (error) { fail(error.message); }
    if (!page.engine) return;
    if (isFitted) page.fit(current().isDrawing);
    tell(find("warnings"), [...whereItTurns(page.engine), ...structure.warnings].join("\n"));
    tell(find("about"), page.engine.isChanged ? "" : structure.description);
    panel.draw(structure, name => valueOf(state.scene, name));
    showRun(state.scene === data.scene ? data.run : null);
    if (isFitted) drawRest();
    else drawAll(state);
  };
  page.fit = (isKept, places = []) => picture.fit(page.engine, isKept, [...places, ...(secondOf(store.state.view)?.box ?? [])]);
  /** Show the time line of a run {time, input, rate, acceleration, words}, of none the button that asks for it. */
  const showRun = run => {
    page.run = run?.time ? run : null;
    find("run").hidden = !structure.isMovedByTorque || !(run || data.canAsk);
    find("simulate").hidden = find("until").parentElement.hidden = !data.canAsk;
    Object.assign(find("time"), { hidden: !page.run, max: page.run ? run.time.length - 1 : 0, value: 0 });
    if (run) tell(find("runWords"), run.problem ?? run.words);
  };
  const goTo = moment => store.dispatch({ view: { at: page.run.input[moment], moment } });
  find("time").oninput = event => (page.play(false), goTo(Number(event.target.value)));
  find("simulate").onclick = async () => {
    const { scene } = store.state;
    let until;
    try { until = page.numberOf("seconds of the run", find("until").value, "s"); } catch (error) { return tell(find("runWords"), error.message); }
    tell(find("runWords"), "integrating ...");
    const run = await page.ask("run", { until });
    if (isOtherNow(scene)) return;
    showRun(run);
    if (page.run) page.play(true);
  };
  /** Nothing is drawn of an empty scene. */
  const blank = () => {
    [page.engine, made, hasTurned] = [null, null, false];
    picture.clear();
    panel.clear();
    for (const name of ["curves", "about", "warnings", "pose", "chooser"]) find(name).replaceChildren();
    delete find("chooser").dataset.names;
    fail("");
  };
  let isWaiting = false;
  /** Draw the picture; what is read afterwards comes when the browser has time, at most ten times a second. */
  const drawAll = state => {
    curves.extrema = [];
    drawPose(state);
    if (!isWaiting) setTimeout(whenIdle, 100, drawRest, { timeout: 200 });
    isWaiting = true;
  };
  const drawRest = () => {
    const { engine, store: { state } } = page;
    isWaiting = false;
    if (!engine) return;
    picture.drawTraces(engine, state.view.layers);
    panel.drawFacts(engine);
    const { extrema, proof } = isAnswered(state) ? answered : { extrema: wanted(state.view).flatMap(name => engine.extremes(name)), proof: SAMPLED };
    const ofCurves = chosenCurves(state.view).flatMap(name => extrema.filter(one => one.quantity === name).sort((one, two) => Math.abs(two.value) - Math.abs(one.value) || 0)), forces = forcesOf(structure);
    curves.draw(engine, chosenCurves(state.view), isAnswered(state) ? ofCurves : [], secondOf(state.view));
    panel.drawExtrema(structure, [...largestForces(structure, extrema.filter(one => forces.includes(one.quantity))), ...ofCurves], [proof, ...new Set(ofCurves.filter(one => one.proof).map(one => `${shownName(structure, one.quantity)}: ${one.proof}.`))].join(" "));
    if (data.canAsk && !isAnswered(state)) askExtremaSoon();
    choose(state);
    drawPose(state);
  };
  const drawPose = ({ view: { at, moment, layers } }) => {
    const { engine } = page, [away, x] = engine.nearestInside(at), here = engine.counted(x), isRun = page.run && moment !== null;
    engine.at(x, ...(isRun ? [page.run.rate[moment], page.run.acceleration[moment]] : []));
    const near = curves.extrema.filter(one => one.inputs.some(input => Math.abs(input - here) < 1e-5 * engine.span) && one.isGlobal && one.kind !== "constant");
    const note = near.slice(0, 2).map(({ kind, quantity, value }) => {
      const [unit, factor] = shownUnit(structure.quantities[quantity].unit);
      return `${kind} of ${shownName(structure, quantity)}: ${significant(value * factor)} ${unit}`;
    }).join(", ");
    const second = secondOf(store.state.view);
    second?.at(second.inside(x));
    picture.draw(engine, layers, second);
    tell(find("pose"), engine.status === 1 || away > 1e-6 * engine.span ? `no pose at ${structure.input.name} = ${significant(at * factorOf())} ${inputUnit()[0]}${engine.status === 1 ? "" : ": the nearest is shown"}` : engine.status === 2 && structure.hasLoads ? "no loads here: links lie in line, it locks itself, or a spring has no direction" : [isRun ? `in the run at ${significant(page.run.time[moment])} s, ${structure.input.rate} = ${significant(page.run.rate[moment])} ${structure.input.unit}/s` : note, structure.lacks].filter(Boolean).join("; "));
    if (isRun) find("time").value = moment;
    curves.follow(engine, here);
    const slider = find("at"), [low, high] = [engine.ranges[0][0], engine.ranges.at(-1)[1]].map(end => end * factorOf());
    for (const [name, value] of Object.entries({ min: low, max: high, step: (high - low) / 720 })) if (slider[name] !== String(value)) slider[name] = value;
    slider.value = here * factorOf();
    slider.setAttribute("aria-valuetext", `${significant(here * factorOf())} ${inputUnit()[0]}`);
    Object.assign(inputField, { unit: structure.input.unit, plainUnit: inputUnit()[0] });
    accelerationField.unit = accelerationField.plainUnit = `${structure.input.unit}/s^2`;
    tell(accelerationName, `acceleration of the input [${structure.input.unit}/s²] `);
    inputField.set(Number((here * factorOf()).toPrecision(6)));
    tell(find("atName"), `${structure.input.name} [${inputUnit()[0]}]`);
    panel.drawValues(engine);
    if (layers.polygons) for (const order of [0, 1]) drawPolygon(find(`polygon${order}`), engine, order);
    current().redraw?.();
  };
  const choose = ({ view }) => {
    const chosen = chosenCurves(view), box = find("chooser"), names = Object.keys(structure.quantities);
    if (box.dataset.names !== names.join(" ")) {
      box.dataset.names = names.join(" ");
      const change = () => store.dispatch({ view: { curves: [...box.querySelectorAll(":checked")].map(one => one.value) } });
      box.replaceChildren(...names.map(name => tickBox(shownName(structure, name), false, change, { value: name, title: structure.quantities[name].text })));
    }
    for (const one of box.querySelectorAll("input")) one.checked = chosen.includes(one.value);
  };
  const remember = later(200, () => {
    if (find("play").getAttribute("aria-pressed") === "true") return;
    const address = addressOf(store.state, isDrawing() ? null : data.scene, factorOf());
    if (address.length <= MOST_ADDRESS) history.replaceState(null, "", address);
  });
  /** Draw the scene by the formulas that are there, or by those that the server has for it. */
  const open = async (isFirst = false) => {
    const { scene } = store.state, isKnown = made && !isOther(scene, made);
    if (isNothing(scene)) return blank();
    if (isKnown) {
      fail("");
      build(store.state, isFirst);
    } else if (!data.canAsk) fail("this file has no server: another structure, or a number that this one lacks, needs fourbar live");
    if (data.canAsk && isKnown && !isFirst) askSoon();
    else if (data.canAsk && !(isFirst && page.isAsWritten())) await askStructure();
  };
  store.subscribe((state, before) => {
    if (state.scene !== before.scene) {
      [notice, refusal] = ["", ""];
      page.say(current().hint ?? "");
      showName();
      open().catch(error => page.refuse(error.message));
    } else if (page.engine && (state.view.acceleration !== before.view.acceleration)) build(state, false);
    else if (page.engine && (state.view.curves !== before.view.curves || state.view.layers !== before.view.layers)) drawRest();
    else if (page.engine) drawPose(state);
    find("undo").disabled = !store.past.length;
    find("redo").disabled = !store.future.length;
    remember();
  });

  // --- tools: what the pointer does in the picture ---
  const current = () => page.tools[store.state.view.tool] ?? page.tools.pose;
  const hitOf = event => Object.fromEntries(["joint", "spring"].map(name => [name, event.target.closest?.(`[data-${name}]`)?.dataset[name]]));
  page.addButton = (name, label, title, onclick) => find("tools").append(html("button", { type: "button", textContent: label, title, onclick, "data-tool": name }));
  page.addTool = tool => {
    page.tools[tool.name] = tool;
    page.addButton(tool.name, tool.label, tool.title, () => page.useTool(tool.name));
  };
  page.useTool = name => {
    current().end?.();
    picture.over.replaceChildren();
    store.dispatch({ view: { tool: name } });
    svg.dataset.tool = name;
    current().begin?.();
    page.say(current().hint ?? "");
    for (const button of find("tools").children) if (button.dataset.tool in page.tools) button.setAttribute("aria-pressed", button.dataset.tool === name);
  };
  /** Zoom and move the picture; without a factor all of it is shown. */
  const look = (factor, ...places) => {
    if (factor) picture.zoom(factor, ...places);
    else {
      picture.view.isChosen = false;
      if (page.engine) page.fit(false);
      else picture.clear();
    }
    if (!page.engine) return current().redraw?.();
    picture.drawTraces(page.engine, store.state.view.layers);
    drawPose(store.state);
  };
  find("fit").onclick = () => look(0);
  svg.addEventListener("wheel", event => {
    event.preventDefault();
    look(2 ** (-event.deltaY * (event.deltaMode ? 0.1 : event.ctrlKey ? 0.02 : 0.0025)), picture.at(event));
  }, { passive: false });
  // one pointer acts as the tool says or pulls the ground, two fingers zoom
  const down = new Map();               // {pointer: its last event}
  let pointer = null, waiting = null, latest = null, isPulled = false;
  const begin = event => {
    [waiting, pointer, latest] = [null, event.pointerId, event];
    isPulled = event.button === 1 || current().down?.(picture.metres(event), event, hitOf(event)) === false;
    if (isPulled && event.pointerType === "touch") pointer = null;      // the page scrolls
  };
  const end = event => {
    pointer = null;
    if (!isPulled) current().up?.(picture.metres(event), event, hitOf(event));
    isPulled = false;
    store.seal();
  };
  svg.addEventListener("pointerdown", event => {
    if (event.button > 1) return;
    svg.setPointerCapture(event.pointerId);
    event.preventDefault();
    down.set(event.pointerId, event);
    if (down.size > 1) {
      waiting = null;
      if (pointer !== null) end(latest);
    } else if (event.pointerType === "touch" && current().isDrawing) waiting = event;      // a second finger may come
    else begin(event);
  });
  svg.addEventListener("pointermove", event => {
    const before = down.get(event.pointerId), [x, y] = picture.at(event);
    if (before) down.set(event.pointerId, event);
    if (before && down.size === 2) {
      const [[x0, y0], [u, v]] = [before, ...[...down.values()].filter(other => other !== event)].map(other => picture.at(other));
      return look(Math.hypot(x - u, y - v) / Math.hypot(x0 - u, y0 - v), [(x0 + u) / 2, (y0 + v) / 2], [(x - x0) / 2, (y - y0) / 2]);
    }
    if (waiting && Math.hypot(event.clientX - waiting.clientX, event.clientY - waiting.clientY) > 8) begin(waiting);
    if (waiting || (pointer !== null && event.pointerId !== pointer)) return;
    if (isPulled && before) {
      const [x0, y0] = picture.at(before);
      return look(1, [x, y], [x - x0, y - y0]);
    }
    latest = event;
    current().move?.(picture.metres(event), event, hitOf(event));
  });
  for (const kind of ["pointerup", "pointercancel", "lostpointercapture"]) svg.addEventListener(kind, event => {
    down.delete(event.pointerId);
    if (waiting && event.type === "pointerup") begin(waiting);
    waiting = null;
    // an event that is taken away tells no place
    if (event.pointerId === pointer) end(event.type === "pointerup" ? event : latest);
  });
  // a finger on a grip moves it, two zoom, and both scroll nothing
  svg.addEventListener("touchstart", event => (event.touches.length > 1 || event.target.closest?.(".grip")) && event.preventDefault(), { passive: false });
  let held = null, pressed = null;          // a click is no drag
  page.addTool({ name: "pose", label: "Move", title: "Drag a joint: the mechanism follows",
    down(place, event, hit) {
      if (!hit.joint || !page.engine) return false;
      [held, pressed] = [hit.joint, event];
      picture.chosen = structure.sketch.loadsAt?.[held]?.[0];
      page.play(false);
      svg.querySelector(`[data-joint="${CSS.escape(held)}"]`)?.focus({ preventScroll: true });
      return true;
    },
    move(place, event) {
      if (pressed && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) > 3) pressed = null;
      if (held && !pressed) store.dispatch({ view: { at: page.engine.nearest(held, place, page.engine.x) } });
    },
    up(place, event) { this.move(place, event); held = null; } });
  // a tool by keys: arrows move a cross, by 20 px or with Shift by one, Enter clicks, Space presses and lets go
  let cross = null, isPressed = false;
  const byKeys = event => {
    const tool = current(), way = WAYS[event.key];
    if (event.target !== svg || !tool.isDrawing || !(way || event.key === "Enter" || event.key === " ")) return false;
    event.preventDefault();
    cross ??= { at: [picture.width / 2, picture.height / 2], mark: draw(svg, "path", { class: "cross" }) };
    if (way) cross.at = cross.at.map((value, i) => value + way[i] * (event.shiftKey ? 1 : 20));
    cross.mark.setAttribute("d", `M${cross.at}m-9 0h18m-9-9v18`);
    const box = svg.getBoundingClientRect(), [clientX, clientY] = [box.left + cross.at[0], box.top + cross.at[1]];
    const place = picture.metres({ clientX, clientY }), hit = hitOf({ target: document.elementFromPoint(clientX, clientY) ?? svg });
    if (event.key === " ") isPressed = !isPressed;
    for (const act of way ? ["move"] : event.key === "Enter" ? ["down", "up"] : isPressed ? ["down"] : ["up"]) tool[act]?.(place, event, hit);
    if (!way && !isPressed) store.seal();
    return true;
  };
  svg.addEventListener("blur", () => (cross?.mark.remove(), (cross = null)));
  svg.addEventListener("keydown", event => {
    const zoom = { "+": 1.25, "=": 1.25, "-": 0.8, 0: 0 }[event.key], pull = event.ctrlKey && WAYS[event.key];
    if (zoom !== undefined || pull) {
      event.preventDefault();
      return pull ? look(1, [0, 0], pull.map(part => -40 * part)) : look(zoom, [picture.width / 2, picture.height / 2]);
    }
    if (byKeys(event) || current().key?.(event) || !page.engine) return;
    const [low, high] = [page.engine.ranges[0][0], page.engine.ranges.at(-1)[1]], step = (high - low) / 180;
    const x = page.engine.x, at = { ArrowRight: x + step, ArrowUp: x + step, ArrowLeft: x - step, ArrowDown: x - step, Home: low, End: high }[event.key];
    if (at === undefined || store.state.view.tool !== "pose") return;
    event.preventDefault();
    page.go(page.engine.inside(page.engine.turnsFully ? at : Math.min(Math.max(at, low), high)));
  });
  // what is open, and what was said of the click before, ends at a click elsewhere and at Escape
  const closeMenus = target => [...document.querySelectorAll("details.menu[open]")].filter(menu => !menu.contains(target)).map(menu => (menu.open = false));
  addEventListener("pointerdown", event => {
    closeMenus(event.target);
    page.refuse("");
  }, true);
  addEventListener("keydown", event => { if (event.key === "Escape" && closeMenus(null).length) event.stopPropagation(); }, true);
  addEventListener("keydown", event => {
    const key = event.key?.toLowerCase();
    if ((event.ctrlKey || event.metaKey) && "zy".includes(key) && event.target.type !== "text") {
      event.preventDefault();
      if (key === "y" || event.shiftKey) store.redo(); else store.undo();
    } else if (event.key === " " && event.target === document.body) (event.preventDefault(), page.play());
    else if (event.key === "Escape" && store.state.view.tool !== "pose") page.useTool("pose");
    else if (event.target === document.body) current().key?.(event);
  });

  // --- play ---
  let last = 0, way = 1, lag = 0;         // of a run: time since the moment that is shown [s]
  page.play = (isPlaying = find("play").getAttribute("aria-pressed") !== "true") => {
    find("play").setAttribute("aria-pressed", isPlaying);
    find("play").textContent = isPlaying ? "❚❚" : "▶";
    last = performance.now();
    if (isPlaying) requestAnimationFrame(advance);
    else remember();
  };
  const advance = now => {
    if (find("play").getAttribute("aria-pressed") !== "true" || !page.engine) return;
    const { engine, run } = page, seconds = Math.min((now - last) / 1000, 0.2), { pace, moment } = store.state.view;
    last = now;
    requestAnimationFrame(advance);
    if (run) {                  // as long as it lasts, then again
      const time = (run.time[moment ?? 0] + lag + seconds) % run.time.at(-1), next = Math.max(run.time.findLastIndex(one => one <= time), 0);
      lag = time - run.time[next];
      return goTo(next);
    }
    const [low, high] = engine.ranges.find(([from, to]) => from <= engine.x + 1e-9 && engine.x <= to + 1e-9) ?? engine.ranges[0];
    const there = ((high - low) * seconds) / pace, x = engine.x + (engine.turnsFully ? there : 2 * way * there);
    if (x <= low || x >= high) way = x <= low ? 1 : -1;
    store.dispatch({ view: { at: engine.turnsFully ? engine.counted(x) : engine.inside(Math.min(Math.max(x, low), high)) } });
  };
  find("play").onclick = () => page.play();
  page.go = at => (page.play(false), store.dispatch({ view: { at } }));
  find("at").oninput = event => page.go(Number(event.target.value) / factorOf());
  find("pace").oninput = event => store.dispatch({ view: { pace: Number(event.target.value) } });
  const [accelerationField, accelerationWords] = numberField("acceleration of the input", `${structure.input.unit}/s^2`, store.state.view.acceleration, page, acceleration => store.dispatch({ view: { acceleration } }));
  const accelerationName = html("span");
  find("more").append(html("label", {}, accelerationName, accelerationField, accelerationWords));
  const LAYERS = { forces: "forces", values: "their values", curves: "paths of points", centres: "instant centres, collineation", polygons: "polygons", second: data.second ? "second scene, pale" : "as it was, pale" };
  for (const [name, words] of Object.entries(LAYERS)) find("more").append(tickBox(words, ["forces", "values", "curves", ...(data.second ? ["second"] : [])].includes(name), event => {
    if (name === "polygons") find("polygons").hidden = !event.target.checked;
    store.dispatch({ view: { layers: { ...store.state.view.layers, [name]: event.target.checked } } });
  }));
  find("undo").onclick = () => store.undo();
  find("redo").onclick = () => store.redo();
  find("theme").onclick = () => {
    const isDark = document.documentElement.dataset.theme ? document.documentElement.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    document.documentElement.dataset.theme = isDark ? "light" : "dark";
  };

  // --- files ---
  const send = (content, suffix, type) => {
    const url = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
    html("a", { href: url, download: `${nameNow()}.${suffix}` }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
  };
  const pictureFile = () => picture.file(find("picture-style").textContent);
  page.files = {
    "scene (YAML)": () => send(yamlOf(store.state.scene, data.integers), "yaml", "application/yaml"),
    "picture (SVG)": () => send(pictureFile(), "svg", "image/svg+xml"),
    "picture (PNG)": () => {
      const image = new Image(), canvas = html("canvas", { width: 3 * picture.width, height: 3 * picture.height });
      image.onload = () => {
        canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
        canvas.toBlob(blob => send(blob, "png"));
      };
      image.src = `data:image/svg+xml,${encodeURIComponent(pictureFile())}`;
    },
    "curves (CSV, mm and degrees)": () => {
      const { engine } = page, columns = [structure.input.name, ...Object.keys(structure.quantities).filter(name => name !== structure.input.name)];
      const shown = unit => (unit === "m" ? ["mm", 1000] : shownUnit(unit)), unitOf = name => shown(name === structure.input.name ? structure.input.unit : structure.quantities[name].unit);
      const all = columns.map((name, i) => (i ? engine.samples(name) : engine.sweep.inputs).map(value => value * unitOf(name)[1]));
      const rows = all[0].map((_, k) => all.map(column => (Number.isFinite(column[k]) ? column[k] : "")).join(","));
      send([columns.map(name => `${name} [${unitOf(name)[0]}]`).join(","), ...rows, ""].join("\n"), "csv", "text/csv");
    },
    "page without a server (HTML)": async () => {
      const { scene } = store.state, known = structure, { run } = page, name = nameNow();       // another one may be drawn while it waits
      const extrema = data.canAsk ? await page.ask("extrema", { quantities: Object.keys(known.quantities), acceleration: 0 }) : page.isAsWritten() ? data.extrema : null;
      const text = JSON.stringify({ ...data, extrema, name, canAsk: false, canSave: false, run, scene, structure: { ...known, index: undefined } });
      send(source.replace("connect-src 'self'", "connect-src 'none'").replace(/(<script[^>]*id="data"[^>]*>)[^]*?(<\/script>)/, (_, begin, end) => begin + text.replaceAll("<", "\\u003c") + end), "html", "text/html");
    },
    ...(data.canAsk && { "moving picture (GIF)": async () => {
      const { problem: why, gif } = await page.ask("gif");
      if (why) page.refuse(why);
      else send(new Blob([Uint8Array.from(atob(gif), letter => letter.charCodeAt(0))]), "gif");
    }, "check": async () => {
      const { problem: why, warnings } = await page.ask("check");
      page.say(why || warnings.join("; ") || "checked: no problem");
    } }),
    ...(data.canSave && { "save in its file": async () => {
      const { problem: why, saved } = await page.ask("save");
      page.say(why ?? `saved: ${saved}`);
    } }),
  };
  for (const [words, act] of Object.entries(page.files)) find("files").append(html("button", { type: "button", textContent: words, onclick: () => (problem && words !== "scene (YAML)" ? page.say(`nothing to save: ${problem}`) : act()) }));

  addEventListener("resize", later(100, () => page.engine && (page.fit(false), drawAll(store.state))));
  addEventListener("hashchange", () => {
    try {
      const { scene, view: { at, acceleration = 0, curves = null } } = readAddress(location.hash, data.scene);
      store.dispatch({ scene, view: { acceleration, curves, ...(at !== undefined && { at: at / factorOf() }) } });
    } catch (error) { page.refuse(error.message); }
  });
  addDrawing(page);
  page.useTool("pose");
  showName();
  made = data.scene;
  await open(true);
  if (isNothing(store.state.scene)) page.useTool("rods");
  if (page.engine) store.dispatch({ view: { at: "at" in first.view ? first.view.at / factorOf() : page.engine.inside(store.state.view.at) } });       // a slide begins where it can be
  page.refuse("");                        // what is wrong with the address is said
  document.documentElement.dataset.ready = "yes";
  return page;
}
