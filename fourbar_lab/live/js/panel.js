// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// What stands beside the picture: a field for each number of the scene, the values of the pose, extrema, facts.
import { TURN } from "./engine.js";
import { significant } from "./picture.js";
import { shownName, shownUnit } from "./curves.js";
const SPAN = 2.5;      // sliders reach so many times the first value
const GROUP_NAMES = { linkage: "Linkage", dyads: "Dyads", cylinder: "Cylinder", drive: "Input", gravity: "Gravity", bodies: "Masses", springs: "Springs", torsion_springs: "Torsion springs", forces: "Forces over a position", external: "Loads from outside", friction: "Friction", points: "Points" };
const MATERIALS = { steel: 7850, aluminium: 2700, brass: 8500, titanium: 4430, PLA: 1240, oak: 700 };      // [kg/m^3]
const OPEN_GROUPS = ["linkage", "dyads", "drive"];

/** An element of HTML with properties, attributes (names with "-" or "role") and children. */
export function html(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes("-") || name === "role" || name === "for") element.setAttribute(name, value);
    else element[name] = value;
  }
  element.append(...children);
  return element;
}
/** The number that a text means in a unit, with units as scenes have them; RangeError with words. */
export function numberOf(text, unit, units, plainUnit = unit) {
  const trimmed = text.trim(), match = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)$/.exec(trimmed);
  if (/^[-+]?\d*,\d+/.test(trimmed)) throw new RangeError(`must be written ${trimmed.replace(",", ".")}: a comma is no decimal point`);
  const spelled = word => [["²", "2"], ["³", "3"], ["µ", "u"], ["°", "deg"], ["Ω", "ohm"]].reduce((all, [a, b]) => all.replaceAll(a, b), word.replace(/[ ^*·]/g, ""));
  const known = Object.entries(units[unit] ?? { [unit]: 1 }), wanted = spelled(match?.[2] || plainUnit);
  const size = match && known.find(([name]) => spelled(name) === wanted)?.[1];
  if (size === undefined || size === null) throw new RangeError(`must be a number in ${known.map(([name]) => name).join(", ") || "digits"}`);
  // 40mm is 0.04 to the last bit: a decimal size moves the point
  const power = /^1e(-?\d+)$/.exec(size), exponent = /^(.*)[eE]([-+]?\d+)$/.exec(match[1]);
  const value = power ? Number(`${exponent?.[1] ?? match[1]}e${Number(exponent?.[2] ?? 0) + Number(power[1])}`) : Number(match[1]) * Number(size);
  if (!Number.isFinite(value)) throw new RangeError("must be a finite number");
  return value;
}
export const shownNumber = value => String(Number(Number(value).toPrecision(12)));
const sixDigits = text => String(Number(Number(text).toPrecision(6)));

/** A text field for a number, all digits of which it shows while one is in it; it takes effect on Enter or on leaving it, Escape takes back what it had. */
export function numberField(name, unit, value, page, change, plainUnit = unit) {
  const words = html("span", { className: "wrong", role: "alert" });
  const field = html("input", { type: "text", value: sixDigits(value), autocomplete: "off", spellcheck: false, "aria-label": name });
  field.set = shown => {
    if (document.activeElement !== field) field.value = sixDigits(shown);
    field.known = shownNumber(shown);
  };
  field.known = shownNumber(value);
  field.onfocus = () => { if (field.value === sixDigits(field.known)) field.value = field.known; };
  field.onblur = () => { if (!field.hasAttribute("aria-invalid")) field.value = sixDigits(field.known); };
  const take = () => {
    words.textContent = "";
    field.removeAttribute("aria-invalid");
    if (!field.value.trim()) field.value = field.known;
    if (field.value === field.known || field.value === field.taken) return;
    try {
      change(numberOf(field.value, unit, page.units, plainUnit));
      field.taken = field.value;
    } catch (error) {
      words.textContent = `${name} = '${field.value}': ${error.message}`;
      field.setAttribute("aria-invalid", "true");
    }
  };
  field.onchange = take;
  field.onkeydown = event => {
    if (event.key === "Escape") field.value = field.known;
    if (event.key === "Enter") take();
  };
  return [field, words];
}

export class Panel {
  constructor(holder, page) {
    Object.assign(this, { holder, page, fields: new Map(), shape: "" });
    this.parameters = html("section", { className: "parameters", "aria-label": "parameters" });
    this.facts = html("section", { className: "facts", "aria-label": "facts" });
    this.values = html("section", { className: "values", "aria-label": "values of the pose" });
    this.extrema = html("section", { className: "extrema", "aria-label": "extrema" });
    const views = { Extrema: this.extrema, Values: this.values, Numbers: this.parameters, Facts: this.facts };
    const tabs = html("div", { role: "tablist", "aria-label": "views", className: "tabs" });
    for (const [name, view] of Object.entries(views)) {
      const tab = html("button", { type: "button", role: "tab", id: `tab-${name}`, textContent: name, onclick: () => show(name) });
      view.id = `view-${name}`;
      view.setAttribute("role", "tabpanel");
      tab.setAttribute("aria-controls", view.id);
      tabs.append(tab);
    }
    const show = chosen => {
      for (const tab of tabs.children) {
        const isChosen = tab.textContent === chosen;
        tab.setAttribute("aria-selected", isChosen);
        tab.tabIndex = isChosen ? 0 : -1;
        views[tab.textContent].hidden = !isChosen;
      }
      this.open = chosen;
      page.store?.dispatch({ view: { panel: chosen } });
    };
    this.show = show;
    tabs.onkeydown = event => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key], names = Object.keys(views);
      if (!step) return;
      show(names[(names.indexOf(this.open) + step + names.length) % names.length]);
      tabs.querySelector("[aria-selected=true]").focus();
    };
    holder.append(tabs, ...Object.values(views));
    show(page.store.state.view.panel ?? "Numbers");
  }
  /** Make the fields of a structure, or give those that are there the numbers of the state. */
  draw(structure, valueOf) {
    const shape = structure.fields.map(field => field.name).join(" ");
    if (shape !== this.shape) this.build(structure);
    this.shape = shape;
    for (const [name, element] of this.fields) element.set(valueOf(name));
  }
  drawFacts(structure) {
    const caption = this.page.isAsWritten() || this.page.canAsk ? "" : "As the scene was in the file, before what you changed.";
    this.facts.replaceChildren(html("p", { className: "proof", textContent: caption }), html("table", {}, html("tbody", {}, ...structure.facts.map(([name, text]) =>
      html("tr", {}, html("th", { scope: "row", textContent: name }), html("td", { textContent: text }))))));
  }
  /** Show nothing of the scene before. */
  clear() {
    this.shape = "";
    this.fields.clear();
    for (const view of [this.parameters, this.values, this.extrema, this.facts]) view.replaceChildren();
  }
  build(structure) {
    const { page } = this, groups = Map.groupBy ? Map.groupBy(structure.fields, field => field.name.split(".")[0]) : new Map();
    if (!Map.groupBy) for (const field of structure.fields) groups.set(field.name.split(".")[0], [...(groups.get(field.name.split(".")[0]) ?? []), field]);
    this.fields.clear();
    this.parameters.replaceChildren(...[...groups].map(([group, members]) => {
      const box = html("details", { open: OPEN_GROUPS.includes(group) }, html("summary", { textContent: GROUP_NAMES[group] ?? group }));
      for (const { name, unit, text, value, choices } of members) {
        const short = name.split(".").slice(1).join("."), row = html("div", { className: "field", title: text });
        const change = (number, merge = null) => page.store.dispatch({ set: page.alsoChanged({ [name]: number }), merge });
        if (choices) {
          const select = html("select", { "aria-label": name, onchange: () => change(Number(select.value)) },
            ...Object.entries(choices).map(([mode, words]) => html("option", { value: mode, textContent: words })));
          select.set = mode => (select.value = mode);
          this.fields.set(name, select);
          row.append(html("span", { className: "name", textContent: short.replaceAll(".", ".\u200b") }), select);
        } else {
          const [field, words] = numberField(name, unit, value, page, change);
          const size = Math.abs(value) || (unit === "m" ? structure.size : 1), low = value < 0 || !structure.positive.includes(name) ? -SPAN * size : 0;
          const slider = html("input", { type: "range", min: value === 0 ? -size : low, max: value === 0 ? size : SPAN * size, step: size / 200, "aria-label": `${name} slider`,
            oninput: () => change(Number(Number(slider.value).toPrecision(3)), name), onchange: () => page.store.seal() });
          const both = { set: number => (field.set(number), (slider.value = number)) };
          this.fields.set(name, both);
          row.append(html("span", { className: "name", textContent: `${short.replaceAll(".", ".\u200b")}${unit ? ` [${unit}]` : ""}` }), field, slider, words);
          if (name === "bodies.rods.density") {
            const material = html("select", { "aria-label": "material", onchange: () => change(Number(material.value)) }, html("option", { value: "", textContent: "other" }),
              ...Object.entries(MATERIALS).map(([textContent, density]) => html("option", { value: density, textContent })));
            both.set = number => (field.set(number), (slider.value = number), (material.value = Object.values(MATERIALS).includes(number) ? number : ""));
            box.append(html("div", { className: "field" }, html("span", { className: "name", textContent: "material of rods" }), material));
          }
        }
        box.append(row);
      }
      return box;
    }));
  }
  /** The values of the pose, with ten digits. */
  drawValues(engine) {
    if (this.open !== "Values") return;
    const { structure } = engine, names = structure.shown.filter(name => engine.status === 0 || engine.index[name] < engine.module.firstLoad);
    const rows = engine.status === 1 ? [] : names.map(name => {
      const [unit, factor] = shownUnit(engine.module.units[engine.index[name]]);
      return html("tr", {}, html("th", { scope: "row", textContent: structure.words[name] ?? name }), html("td", { className: "number", textContent: String(Number((engine.get(name) * factor).toPrecision(10))) }), html("td", { textContent: unit }));
    });
    this.values.replaceChildren(html("table", {}, html("thead", {}, html("tr", {}, ...["now", "value", "unit"].map(textContent => html("th", { scope: "col", textContent })))), html("tbody", {}, ...rows)));
  }
  /** Extrema of five digits, those of a quantity from the largest, with a button to their input; `proof` says how they were found. */
  drawExtrema(engine, extrema, proof) {
    const { input, quantities } = engine.structure, inputUnit = input.unit === "rad" ? "°" : " m", turns = input.unit === "rad" ? 360 / TURN : 1;
    const order = [...new Set(extrema.map(one => one.quantity))], rank = ({ value }) => (Number.isFinite(value) ? Math.abs(value) : Infinity);
    const sorted = [...extrema].sort((a, b) => order.indexOf(a.quantity) - order.indexOf(b.quantity) || (rank(a) === rank(b) ? 0 : rank(b) - rank(a)));
    const largest = engine.largestJointForce, rows = [...(largest ? [largest] : []), ...sorted].map(({ quantity, kind, value, input: x, isGlobal, note }) => {
      const [unit, factor] = shownUnit(quantities[quantity].unit), at = `${sixDigits(x * turns)}${inputUnit}`, isBounded = Number.isFinite(value);
      const go = html("button", { type: "button", className: "go", textContent: at, "aria-label": `go to the ${kind} of ${quantity} at ${at}`, onclick: () => this.page.store.dispatch({ view: { at: x } }) });
      return html("tr", {}, html("th", { scope: "row", title: quantity, textContent: shownName(engine.structure, quantity) }), html("td", { title: kind }, kind.slice(0, 3), html("small", { textContent: note ?? (isGlobal ? "global" : "") })),
        html("td", { className: "number", title: isBounded ? String(Number((value * factor).toPrecision(10))) : "", textContent: isBounded ? `${Number((value * factor).toPrecision(5))} ${unit}` : "unbounded" }), html("td", {}, go));
    });
    this.extrema.replaceChildren(html("p", { className: "proof", textContent: proof }), html("table", {}, html("thead", {}, html("tr", {}, ...["quantity", "kind", "value", "input"].map(textContent => html("th", { scope: "col", textContent })))), html("tbody", {}, ...rows)));
  }
}
