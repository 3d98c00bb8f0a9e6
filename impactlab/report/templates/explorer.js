"use strict";
const element = (id) => document.getElementById(id);

const highest = Math.max(0, ...responses.flatMap((one) => one.terms.flatMap((term) => term[1].map((f) => f[1]))));

// Orthonormal polynomials, as `Polynomials` of impactlab/analysis/surrogate/chaos.py.
function polynomial(parameter, value) {
  const { centre, scale, diagonal, beside } = parameter.polynomials;
  const z = ((parameter.logarithmic ? Math.log(value * parameter.si) : value * parameter.si) - centre) / scale;
  const found = [1];
  for (let n = 0; n < highest; n++)
    found.push(((z - diagonal[n]) * found[n] - (n ? beside[n] * found[n - 1] : 0)) / beside[n + 1]);
  return found;
}

// Prediction, half-width of its interval, and whether the point is farther out than any run tested
// on, as `predict` of impactlab/analysis/surrogate/stored.py.
function predict(response, polynomials) {
  let value = 0, squares = 0;
  for (const [coefficient, factors] of response.terms) {
    const term = factors.reduce((product, [at, degree]) => product * polynomials[at][degree], 1);
    value += coefficient * term;
    squares += term * term;
  }
  const leverage = squares / response.terms.length;
  const error = response.error * Math.max(leverage, 1) ** (response.growth / 2), extrapolated = leverage > response.reach;
  return { value, error, extrapolated, doubtful: extrapolated || error > imprecise * Math.abs(value) };
}

// As `engineering` of impactlab/model/quantities.py prints a quantity.
function power(value, response) {
  const rounded = Number(value.toPrecision(4));
  if (!rounded || !response.prefixed) return 0;
  return Math.min(Math.max(Math.floor(Math.log10(Math.abs(rounded)) / 3), -3), 5);
}
const unit = (response, p) => ["n", "µ", "m", "", "k", "M", "G", "T", "P"][p + 3] + response.symbol;
function engineering(value, response, digits) {
  const rounded = Number(value.toPrecision(digits)), p = power(rounded, response);
  const number = Number((rounded / 1000 ** p).toPrecision(digits)), size = Math.abs(number);
  const text =
    number && (size >= 1e6 || size < 1e-4)
      ? number.toExponential().replace(/e([+-])(\d)$/, "e$10$2")
      : number.toLocaleString("en-US", { maximumSignificantDigits: 6 });
  return `${text} ${unit(response, p)}`.trim();
}

function ticks(low, high) {
  const least = (high - low) / 5, decade = 10 ** Math.floor(Math.log10(least));
  const step = decade * [1, 2, 5, 10].find((each) => decade * each >= least);
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) found.push(Number((k * step).toPrecision(6)));
  return found;
}

// One plot: axes, band, curve (where it is imprecise, apart), and the point of the sliders.
function plot(response, parameter, moved, x, y) {
  const values = parameter.values, curve = moved.map((each) => predict(response, each));
  const [below, above] = [-1, 1].map((sign) => curve.map((each) => each.value + sign * each.error));
  const low = Math.min(response.lowest, ...below), high = Math.max(response.highest, ...above);
  const scale = parameter.logarithmic ? Math.log : (each) => each;
  const [start, end] = [values[0], values.at(-1)].map(scale);
  const across = (each) => (58 + (330 * (scale(each) - start)) / (end - start)).toFixed(2);
  const up = (each) => (182 - (172 * (each - low)) / (high - low)).toFixed(2);
  const point = (each, at) => `${across(values[at])},${up(each)}`;
  const band = [...above.map(point), ...below.map(point).reverse()];
  const path = (wanted) =>
    curve.map((each, at) => (each.doubtful === wanted ? (curve[at - 1]?.doubtful === wanted ? "L" : "M") + point(each.value, at) : "")).join("");
  const p = power(Math.max(Math.abs(low), Math.abs(high)), response), size = 1000 ** p;
  const rows = ticks(low / size, high / size).map(
    (each) => `<line class="frame" x1="58" x2="388" y1="${up(each * size)}" y2="${up(each * size)}"/>` +
      `<text x="53" y="${up(each * size)}" dy="4" text-anchor="end">${each}</text>`);
  const middle = values[Math.floor(values.length / 2)];
  const columns = [[values[0], "start"], [middle, "middle"], [values.at(-1), "end"]].map(
    ([each, anchor]) => `<text x="${across(each)}" y="200" text-anchor="${anchor}">${Number(each.toPrecision(6))}</text>`);
  const label = parameter.unit ? `${parameter.label} (${parameter.unit})` : parameter.label;
  return rows.join("") + columns.join("") +
    `<text x="223" y="222" text-anchor="middle">${label}</text><text x="4" y="11">${unit(response, p)}</text>` +
    `<polygon class="band" points="${band.join(" ")}"/><path class="doubtful" d="${path(true)}"/>` +
    `<path class="curve" d="${path(false)}"/><line class="at" x1="${across(x)}" x2="${across(x)}" y1="10" y2="182"/>` +
    `<circle class="point" cx="${across(x)}" cy="${up(y)}" r="5"/>`;
}

// The value of a field; NaN, and the reason beside it, where the surrogate knows nothing of it.
function read(parameter) {
  const field = element(parameter.name), value = field.value === "" ? NaN : Number(field.value);
  const inside = value >= parameter.lowest && value <= parameter.highest;
  field.setAttribute("aria-invalid", !inside);
  element(`${parameter.name}-refusal`).textContent = inside ? "" :
    `${Number.isNaN(value) ? "Not a number" : "Outside"}: the surrogate was trained from ${parameter.range}. Choose a value within.`;
  return inside ? value : NaN;
}

function update() {
  const values = parameters.map(read), known = !values.some(Number.isNaN);
  const at = Number(element("against").value), along = parameters[at];
  const polynomials = known ? parameters.map((each, n) => polynomial(each, values[n])) : [];
  const moved = known ? along.values.map((each) => polynomials.with(at, polynomial(along, each))) : [];
  for (const response of responses) {
    const section = element(`response-${response.name}`);
    const [output, drawing] = [section.querySelector("output"), section.querySelector("svg")];
    drawing.innerHTML = output.textContent = "";
    if (!known) {
      output.textContent = "none: a parameter is outside its range";
      continue;
    }
    const { value, error, extrapolated, doubtful } = predict(response, polynomials);
    output.textContent = `${engineering(value, response, 4)} ± ${engineering(error, response, 2)}`;
    if (extrapolated) output.textContent += ", extrapolated: farther out than any run tested on";
    else if (error > Math.abs(value)) output.textContent += ", imprecise: zero lies within the error";
    else if (doubtful)
      output.textContent += `, imprecise: the error is ${((100 * error) / Math.abs(value)).toFixed(0)} % of the prediction`;
    drawing.innerHTML = plot(response, along, moved, values[at], value);
    drawing.setAttribute("aria-label", `${response.label} against ${along.label}: ${output.textContent} at ${values[at]} ${along.unit}`);
  }
  const given = parameters.map((each, n) => ` ${each.name}=` + (each.unit ? `'${values[n]} ${each.unit}'` : values[n]));
  element("command").textContent = known ? `impactlab predict ${surrogate}${given.join("")}` : "";
  element("copy").textContent = "Copy";
}

// Where the page opens: at the medians, or off them where more predictions are precise.
function opening() {
  const doubts = (values) => {
    const polynomials = parameters.map((each, n) => polynomial(each, values[n]));
    return responses.filter((each) => predict(each, polynomials).doubtful).length;
  };
  const places = parameters[0].openings.map((_, n) => parameters.map((each) => each.openings[n]));
  return places.reduce((best, each) => (doubts(each) < doubts(best) ? each : best));
}
const start = opening();

function move(parameter, value) {
  const nearest = parameter.values.findIndex((each) => each >= Number(value));
  const [field, slider] = [element(parameter.name), element(`${parameter.name}-slider`)];
  if (field.value !== String(value)) field.value = value; // else it is being typed
  if (!Number.isNaN(read(parameter))) slider.value = nearest;
  slider.setAttribute("aria-valuetext", `${value} ${parameter.unit}`);
}

// The address holds the values, so that they survive a reload and can be sent to others.
function recall() {
  const state = new URLSearchParams(location.hash.slice(1));
  parameters.forEach((each, n) => move(each, state.get(each.name) ?? start[n]));
  element("against").value = Math.max(0, parameters.findIndex((each) => each.name === state.get("against")));
  update();
}
let waiting;
function remember() {
  const state = new URLSearchParams(parameters.map((each) => [each.name, element(each.name).value]));
  state.set("against", parameters[element("against").value].name);
  clearTimeout(waiting); // browsers refuse a new address at every move of a slider
  waiting = setTimeout(() => history.replaceState(null, "", `#${state}`), 200);
}
const changed = () => (update(), remember());

for (const parameter of parameters) {
  const [field, slider] = [element(parameter.name), element(`${parameter.name}-slider`)];
  slider.addEventListener("input", () => (move(parameter, parameter.values[slider.value]), changed()));
  field.addEventListener("input", () => (move(parameter, field.value), changed()));
}
element("against").addEventListener("input", changed);
element("reset").addEventListener("click", () => {
  clearTimeout(waiting);
  history.replaceState(null, "", "#");
  recall();
});
element("copy").addEventListener("click", async () => {
  getSelection().selectAllChildren(element("command")); // to copy by hand, where the browser refuses
  await navigator.clipboard.writeText(element("command").textContent);
  element("copy").textContent = "Copied";
});
addEventListener("hashchange", () => location.hash.includes("=") && recall());
recall();
