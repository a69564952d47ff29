// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
// What stands beside the picture: a field for each number of the scene, the values of the pose, extrema, facts.
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
/** A decimal number as a whole one times a power of ten: 12in is 0.3048 m to the last bit. */
function decimalOf(text) {
  const [, whole, share = "", power = 0] = /^([-+]?\d*)\.?(\d*)(?:e([-+]?\d+))?$/i.exec(text);
  return { whole: BigInt(whole + share), power: power - share.length };
}
/** {value, hasUnit} of the number that a text means in a unit, with units as scenes have them; RangeError with words. */
export function numberOf(text, unit, units, plainUnit = unit) {
  const trimmed = text.trim(), match = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)$/.exec(trimmed);
  if (/^[-+]?[1-9]\d{0,2}(,\d{3})+(?![\d,])/.test(trimmed)) throw new RangeError(`must be written ${trimmed.replaceAll(",", "")}, or with a decimal point: without a comma`);
  if (/^[-+]?\d*,\d+/.test(trimmed)) throw new RangeError(`must be written ${trimmed.replace(",", ".")}: a comma is no decimal point`);
  const spelled = word => [["²", "2"], ["³", "3"], ["µ", "u"], ["°", "deg"], ["Ω", "ohm"]].reduce((all, [a, b]) => all.replaceAll(a, b), word.replace(/[ ^*·]/g, ""));
  const known = Object.entries(units[unit] ?? { [unit]: 1 }), wanted = spelled(match?.[2] || plainUnit);
  const size = match && known.find(([name]) => spelled(name) === wanted)?.[1];
  if (size === undefined || size === null) throw new RangeError(`must be a number in ${known.map(([name]) => name).join(", ") || "digits"}`);
  const [one, two] = [match[1], size].map(decimalOf), value = Number(`${one.whole * two.whole}e${one.power + two.power}`);
  if (!Number.isFinite(value)) throw new RangeError("must be a finite number");
  return { value, hasUnit: Boolean(match[2]) };
}
const digits = (value, count) => (value === "" || value === null || value === undefined ? "" : String(Number(Number(value).toPrecision(count))));
export const shownNumber = value => digits(value, 12);
const sixDigits = text => digits(text, 6);

/** A text field for a number, all digits of which it shows while one is in it; it takes effect on Enter or on leaving it, Escape takes back what it had; `canBeNone`: emptied it changes to null. */
export function numberField(name, unit, value, page, change, plainUnit = unit, canBeNone = false) {
  const words = html("span", { className: "wrong", role: "alert" });
  const field = html("input", { type: "text", value: sixDigits(value), autocomplete: "off", spellcheck: false, "aria-label": name });
  Object.assign(field, { unit, plainUnit });        // of an input they change with the structure
  field.set = shown => {
    if (document.activeElement !== field && !field.hasAttribute("aria-invalid")) field.value = sixDigits(shown);
    field.known = shownNumber(shown);
  };
  field.known = shownNumber(value);
  field.onfocus = () => { if (field.value === sixDigits(field.known)) field.value = field.known; };
  field.onblur = () => { if (!field.hasAttribute("aria-invalid")) field.value = sixDigits(field.known); };
  const take = () => {
    words.textContent = "";
    field.removeAttribute("aria-invalid");
    if (field.value === field.known) return;
    try {
      const number = canBeNone && !field.value.trim() ? null : page.numberOf(name, field.value, field.unit, field.plainUnit);
      change(number);
      field.known = shownNumber(number);
    } catch (error) {
      words.textContent = error.message;
      field.setAttribute("aria-invalid", "true");
    }
  };
  field.onchange = take;
  field.onkeydown = event => {
    if (event.key === "Escape") field.value = field.known;
    if (event.key === "Escape" || event.key === "Enter") take();
  };
  return [field, words];
}

/** A box to tick with words behind it. */
export const tickBox = (words, checked, onchange, more = {}) => html("label", {}, html("input", { type: "checkbox", checked, onchange, ...more }), words);
/** A choice among [value, words]; of a value that is none of them the first, an empty one is shown alone. */
function selectOf(name, options, change) {
  const select = html("select", { "aria-label": name, onchange: () => change(Number(select.value)) }, ...options.map(([value, textContent]) => html("option", { value, textContent, disabled: value === "" })));
  select.set = value => (select.selectedIndex = Math.max(options.findIndex(option => Number(option[0]) === value && option[0] !== ""), 0));
  return select;
}
/** A table of rows of elements or texts; the first cell names its row. */
function table(columns, rows) {
  const cell = (tag, content, scope) => (content instanceof Element ? content : html(tag, { textContent: content, ...(scope && { scope }) }));
  return html("table", {}, html("thead", {}, html("tr", {}, ...columns.map(name => cell("th", name, "col")))),
    html("tbody", {}, ...rows.map(row => html("tr", {}, ...row.map((content, i) => (i ? cell("td", content) : cell("th", content, "row")))))));
}

export class Panel {
  constructor(holder, page) {
    Object.assign(this, { page, fields: new Map(), shape: "" });
    [this.extrema, this.values, this.parameters, this.facts] = holder.querySelectorAll("section");
    this.isOfValues = holder.querySelector("#show-Values");      // whose table is not laid out for nothing
    holder.querySelector(innerWidth < 700 ? "#show-Extrema" : "#show-Numbers").checked = true;
    holder.addEventListener("change", () => page.engine && this.drawValues(page.engine));
  }
  /** Make the fields of a structure, or give those that are there the numbers of the state. */
  draw(structure, valueOf) {
    const shape = structure.fields.map(field => `${field.name} ${field.unit}`).join(" ");
    if (shape !== this.shape) this.build(structure);
    this.shape = shape;
    for (const [name, element] of this.fields) element.set(valueOf(name));
  }
  drawFacts({ structure, isChanged }) {
    this.facts.replaceChildren(html("p", { className: "proof", textContent: isChanged ? "As the scene was before what you changed." : "" }), table([], structure.facts));
  }
  /** Show nothing of the scene before. */
  clear() {
    this.shape = "";
    this.fields.clear();
    for (const view of [this.parameters, this.values, this.extrema, this.facts]) view.replaceChildren();
  }
  build(structure) {
    const { page, fields } = this, groups = new Set(structure.fields.map(field => field.name.split(".")[0]));
    const chosen = this.parameters.querySelector(":focus")?.getAttribute("aria-label");       // the keyboard stays where it was
    const opened = [...OPEN_GROUPS, ...[...this.parameters.querySelectorAll("details[open]")].map(box => box.dataset.group)];
    fields.clear();
    this.parameters.replaceChildren(...[...groups].map(group => {
      const box = html("details", { open: opened.includes(group), "data-group": group }, html("summary", { textContent: GROUP_NAMES[group] ?? group }));
      for (const { name, unit, text, value, choices } of structure.fields.filter(field => field.name.split(".")[0] === group)) {
        const canBeNone = /^bodies\.\w+\.mass$/.test(name), whole = name.replace(/\.mass$/, "");        // a link without a mass has no centre or inertia
        const change = (number, merge = null) => {
          page.store.dispatch({ set: page.alsoChanged({ [number === null ? whole : name]: number }), merge, typed: name });
          if (number === null) page.say(`${whole} is taken out of the scene; undo brings it back`);
        };
        const words = name.split(".").slice(1).join(".\u200b"), shown = [], followers = [];
        if (choices) shown.push(selectOf(name, Object.entries(choices), change));
        else {
          const [field, wrong] = numberField(name, unit, value, page, change, unit, canBeNone);
          const size = Math.abs(value) || (unit === "m" ? structure.size : 1), low = value < 0 || !structure.positive.includes(name) ? -SPAN * size : 0;
          const slider = html("input", { type: "range", min: value === 0 ? -size : low, max: value === 0 ? size : SPAN * size, step: size / 200, "aria-label": `${name} slider`,
            oninput: () => change(Number(Number(slider.value).toPrecision(3)), name), onchange: () => page.store.seal() });
          slider.set = number => (slider.value = number);
          shown.push(field, ...(value === null ? [] : [slider]), wrong);
        }
        if (name === "bodies.rods.density") {
          const material = selectOf("material", [["", "other"], ...Object.entries(MATERIALS).map(([words, density]) => [density, words])], change);
          box.append(html("div", { className: "field" }, html("span", { className: "name", textContent: "material of rods" }), material));
          followers.push(material);
        }
        fields.set(name, { set: number => [...shown, ...followers].forEach(element => element.set?.(number)) });
        box.append(html("div", { className: "field", title: text }, html("span", { className: "name", textContent: unit && !choices ? `${words} [${unit}]` : words }), ...shown));
      }
      return box;
    }));
    if (chosen) this.parameters.querySelector(`[aria-label="${chosen}"]`)?.focus({ preventScroll: true });
  }
  /** The values of the pose, with ten digits. */
  drawValues(engine) {
    if (!this.isOfValues.checked) return;
    const { structure, module, index } = engine, names = structure.shown.filter(name => engine.status === 0 || index[name] < module.firstLoad);
    this.values.replaceChildren(table(["now", "value", "unit"], engine.status === 1 ? [] : names.map(name => {
      const [unit, factor] = shownUnit(module.units[index[name]]);
      return [structure.words[name] ?? name, html("td", { className: "number", textContent: String(Number((engine.get(name) * factor).toPrecision(10))) }), unit];
    })));
  }
  /** Extrema of five digits with a button to their input; `proof` says how they were found. */
  drawExtrema(structure, extrema, proof) {
    const [unitOfInput, perInput] = shownUnit(structure.input.unit);
    const rows = extrema.map(({ quantity, kind, value, inputs: [input], note }) => {
      const [unit, factor] = shownUnit(structure.quantities[quantity].unit), at = `${sixDigits(input * perInput)}${unitOfInput === "deg" ? "°" : " m"}`, isBounded = Number.isFinite(value);
      return [html("th", { scope: "row", title: quantity, textContent: shownName(structure, quantity) }),
        html("td", { title: kind }, kind === "constant" ? kind : kind.slice(0, 3), html("small", { textContent: note })),
        html("td", { className: "number", title: isBounded ? String(Number((value * factor).toPrecision(10))) : "", textContent: isBounded ? `${Number((value * factor).toPrecision(5))} ${unit}` : "unbounded" }),
        html("td", {}, html("button", { type: "button", className: "go", textContent: at, "aria-label": `go to the ${kind} of ${quantity} at ${at}`, onclick: () => this.page.go(input) }))];
    });
    this.extrema.replaceChildren(html("p", { className: "proof", textContent: proof }), table(["quantity", "kind", "value", "input"], rows));
  }
}
