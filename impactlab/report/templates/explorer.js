"use strict";
const element = (id) => document.getElementById(id);

// The area under the normal density above z: Marsaglia (2004), J. Stat. Softw. 11(4); far out the
// continued fraction of Laplace, as differences of numbers close to 1 have few digits.
function tail(z) {
  if (z < -2) return 1 - tail(-z);
  const density = Math.exp(-z * z / 2) / Math.sqrt(2 * Math.PI);
  if (z > 2) {
    let fraction = z;
    for (let k = 100; k > 0; k--) fraction = z + k / fraction;
    return density / fraction;
  }
  let sum = z, term = z;
  for (let k = 3; k < 80; k += 2) sum += (term *= z * z / k);
  return 0.5 - density * sum;
}
const between = (low, high) => (low > 0 ? tail(low) - tail(high) : tail(-high) - tail(-low));

// The probability of a value below x, as in impactlab/model/distributions.py.
const cumulative = {
  uniform: (x, p) => (x - p.low) / (p.high - p.low),
  log_uniform: (x, p) => Math.log(x / p.low) / Math.log(p.high / p.low),
  normal: (x, p) => tail((p.mean - x) / p.standard_deviation),
  lognormal: (x, p) => tail(Math.log(p.median / x) / Math.log(p.geometric_standard_deviation)),
  truncated_normal(x, p) {
    const [low, z, high] = [p.low, x, p.high].map((each) => (each - p.mean) / p.standard_deviation);
    return between(low, z) / between(low, high);
  },
  triangular: (x, p) =>
    x <= p.mode && p.mode > p.low
      ? (x - p.low) ** 2 / ((p.high - p.low) * (p.mode - p.low))
      : 1 - (p.high - x) ** 2 / ((p.high - p.low) * (p.high - p.mode)),
};

const highest = Math.max(0, ...responses.flatMap((one) => one.terms.flatMap((term) => term[1].map((f) => f[1]))));

// Legendre polynomials of variance one, as `basis` of impactlab/analysis/surrogate/chaos.py.
function legendre(parameter, value) {
  const u = 2 * Math.min(Math.max(cumulative[parameter.distribution](value, parameter), 0), 1) - 1;
  const plain = [1, u];
  for (let n = 2; n <= highest; n++)
    plain.push((plain[n - 1] * u * (2 * n - 1) - plain[n - 2] * (n - 1)) / n);
  return plain.map((each, n) => Math.sqrt(2 * n + 1) * each);
}

function predict(response, polynomials) {
  let sum = 0;
  for (const [coefficient, factors] of response.terms)
    sum += factors.reduce((product, [at, degree]) => product * polynomials[at][degree], coefficient);
  return sum;
}

// How many times larger the error is at the ends of the parameters' ranges, and of which it is so.
function enlarged(response, polynomials) {
  const limit = Math.sqrt(3) * (1 - 2 * outer);
  const ratios = polynomials.map((each, at) => (Math.abs(each[1]) > limit ? response.outer[at] : 1));
  const ratio = Math.max(...ratios);
  return [ratio, parameters[ratios.indexOf(ratio)].label];
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
  const errors = moved.map((each) => response.rmse * enlarged(response, each)[0]);
  const [below, above] = [-1, 1].map((sign) => curve.map((each, at) => each + sign * errors[at]));
  const low = Math.min(response.lowest, ...below), high = Math.max(response.highest, ...above);
  const scale = parameter.logarithmic ? Math.log : (each) => each;
  const [start, end] = [values[0], values.at(-1)].map(scale);
  const across = (each) => (58 + (330 * (scale(each) - start)) / (end - start)).toFixed(2);
  const up = (each) => (182 - (172 * (each - low)) / (high - low)).toFixed(2);
  const point = (each, at) => `${across(values[at])},${up(each)}`;
  const band = [...above.map(point), ...below.map(point).reverse()];
  const doubtful = curve.map((each, at) => errors[at] > imprecise * Math.abs(each));
  const path = (wanted) =>
    curve.map((each, at) => (doubtful[at] === wanted ? (doubtful[at - 1] === wanted ? "L" : "M") + point(each, at) : "")).join("");
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
  const polynomials = known ? parameters.map((each, n) => legendre(each, values[n])) : [];
  const moved = known ? along.values.map((each) => polynomials.with(at, legendre(along, each))) : [];
  for (const response of responses) {
    const section = element(`response-${response.name}`);
    const [output, drawing] = [section.querySelector("output"), section.querySelector("svg")];
    const ends = section.querySelector("small");
    drawing.innerHTML = output.textContent = ends.textContent = "";
    if (!known) {
      output.textContent = "none: a parameter is outside its range";
      continue;
    }
    const value = predict(response, polynomials);
    const [ratio, label] = enlarged(response, polynomials), error = ratio * response.rmse;
    output.textContent = `${engineering(value, response, 4)} ± ${engineering(error, response, 2)}`;
    if (error > imprecise * Math.abs(value))
      output.textContent += `, imprecise: the error is ${((100 * error) / Math.abs(value)).toFixed(0)} % of the prediction`;
    if (ratio > 1) ends.textContent = `${ratio} times the usual error, as at the ends of “${label}”.`;
    drawing.innerHTML = plot(response, along, moved, values[at], value);
    drawing.setAttribute("aria-label", `${response.label} against ${along.label}: ${output.textContent} at ${values[at]} ${along.unit}`);
  }
  const given = parameters.map((each, n) => ` ${each.name}=` + (each.unit ? `'${values[n]} ${each.unit}'` : values[n]));
  element("command").textContent = known ? `impactlab predict surrogate.nc${given.join("")}` : "";
}

for (const parameter of parameters) {
  const [field, slider] = [element(parameter.name), element(`${parameter.name}-slider`)];
  const follow = () => {
    field.value = parameter.values[slider.value];
    slider.setAttribute("aria-valuetext", `${field.value} ${parameter.unit}`);
  };
  slider.addEventListener("input", () => (follow(), update()));
  field.addEventListener("input", () => {
    const nearest = parameter.values.findIndex((each) => each >= Number(field.value));
    if (!Number.isNaN(read(parameter))) slider.value = nearest;
    update();
  });
  slider.value = Math.floor(parameter.values.length / 2);
  follow();
}
element("against").addEventListener("input", update);
update();
