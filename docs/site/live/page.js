// The page: settings, the worker, what is shown as rows arrive, links, files.
const byId = id => document.getElementById(id);
const facts = JSON.parse(byId("facts").textContent);
const exponentsOf = e => e === 10 ? "double's" : `±${2 ** (e - 1) - 1}`;
const roundings = ["to nearest", "toward zero", "stochastic"];

/** Of each setting of the library's list: its group, its words, how a value reads; or a choice, or a switch. */
const words = {
  bits: ["arithmetic", "Bits of significand", v => v + ({ 8: " (bfloat16)", 11: " (binary16)", 24: " (float)",
                                                         53: " (double)" }[v] || "")],
  exponents: ["arithmetic", "Range of exponents", exponentsOf],
  rounding: ["arithmetic", "Rounding", roundings],
  lambda: ["filter", "Forgetting λ", v => v.toFixed(3)],
  prior: ["filter", "P at the start", v => v === 0 ? "1" : `2^${v}`],
  gain_error: ["filter", "Error in the gain", v => v === -41 ? "none" : `2^${v}`],
  guard: ["filter", "A guard around each", ["none"]],    // and those of the library
  parameters: ["data", "Parameters", String],
  rows: ["data", "Rows", String],
  condition: ["data", "Condition number", v => `10^${v.toFixed(1)}`],
  units: ["data", "Its cause", ["rotated regressors", "different units"]],
  noise: ["data", "Noise", v => v.toFixed(2)],
  seed: ["data", "Seed", String],
  outlier: ["trouble", "An outlier (100 at row 0.4 N)"],
  silent: ["trouble", "Silence (ψ = 0 from 0.55 N to 0.75 N)"],
  change: ["trouble", "A changed system (from 0.8 N)"],
  format: f => `${f.bits} bits, exponents ${exponentsOf(f.exponents)}, ${roundings[f.rounding]}`,
};
const ofMadeRows = ["parameters", "rows", "condition", "units", "noise", "seed"];
const looks = {    // a family has a colour, a variant a dash
  conventional: ["conventional", []], symmetric: ["symmetric", []], joseph: ["joseph", []],
  joseph_rank_two: ["joseph", [5, 3]], potter: ["root", []], ud: ["ud", []], ud_delta: ["ud", [2, 2]],
  inverse_qr: ["ud", [7, 3]], information: ["normal", []], qr: ["qr", []],
};
const stories = {
  "conventional in 16 bits": {}, "in double": { bits: 53 },
  "bfloat16, stochastic": { bits: 8, exponents: 8, rounding: 2 },
  "an error in the gain": { bits: 53, gain_error: -12 },
  "silence winds P up": { bits: 24, silent: 1, lambda: 0.95 },
  "nearly collinear": { bits: 24, condition: 4, lambda: 1 },
  "everything, with a guard": { bits: 24, outlier: 1, silent: 1, change: 1, guard: 1, lambda: 0.95 },
};

let settings, guards, variants, parametersMost;
const page = { values: {}, chosen: new Set(), focus: "", record: "", model: null, columns: null };
const worker = new Worker(URL.createObjectURL(new Blob([byId("worker").textContent], { type: "text/javascript" })));
const waiting = new Map();
let nextId = 0;
/** The worker's answer. */
const ask = order => new Promise(answered => {
  waiting.set(++nextId, answered);
  worker.postMessage({ ...order, id: nextId });
});
worker.onmessage = ({ data }) => {
  if (data.type === "ready") return begin(data);
  if (data.type === "failed") return worker.onerror(data);
  waiting.get(data.id)(data);
  waiting.delete(data.id);
};
worker.onerror = e => { byId("status").textContent = `The page cannot run here: ${e.message}`; };

// --- what runs ------------------------------------------------------------------------------------------------------

/** What is sent: formats that the library has. `notes` say what is not as it was set. */
function effective() {
  const v = { ...page.values }, notes = [];
  if (v.bits > 25 && (v.exponents < 10 || v.rounding > 0)) {
    v.exponents = 10;
    v.rounding = 0;
    notes.push("more than 25 bits: exponents are double's, and rounding is to nearest");
  }
  if (v.rounding > 0 && v.exponents === 10) {
    v.exponents = 8;
    notes.push("rounding other than to nearest: exponents are float's");
  }
  const greatest = v.exponents === 10 ? 1023 : 2 ** (v.exponents - 1) - 1;
  if (v.prior > greatest - 1) {
    v.prior = greatest - 1;
    notes.push(`P at the start is 2^${v.prior}, near the greatest number`);
  }
  v.table = page.model ? 1 : 0;
  return { values: v, notes };
}
const rowsWanted = () => page.model ? page.model.rows : page.values.rows;

/** What was computed from one start on. */
class Run {
  constructor(sent, answer) {
    Object.assign(this, { sent, d: answer.d, stored: answer, taken: 0, first: 1, ended: false, summaries: null });
    this.digits = variants.map(() => []);
    this.measured = [];    // {row, of: for each variant and the reference {digits, spectrum}}
  }
  add(answer, keep) {
    for (const block of answer.digits) block.forEach((numbers, v) => this.digits[v].push(...numbers));
    const wide = 1 + parametersMost;
    for (const m of answer.measures)
      for (let at = 0; at < m.length; at += answer.width)
        this.measured.push({ row: m[at], of: Array.from({ length: variants.length + 1 }, (_, v) =>
          ({ digits: m[at + 1 + v * wide], spectrum: m.slice(at + 2 + v * wide, at + 2 + v * wide + this.d) })) });
    this.taken += answer.taken;
    this.summaries = answer.summaries;
    this.theta = answer.theta;
    const dropped = this.taken - this.first + 1 - keep;
    if (dropped > keep) {    // rarely, so that it costs little a row
      this.digits = this.digits.map(numbers => numbers.slice(dropped));
      this.first += dropped;
      this.measured = this.measured.filter(m => m.row >= this.first);
    }
  }
  /** How many digits the reference may be trusted for: 2^-104 by the square of the condition. */
  carried() {
    const last = this.measured[this.measured.length - 1], s = last && last.of[variants.length].spectrum;
    return s ? 31 - Math.max(0, Math.log10(s[0] / s[this.d - 1])) : 31;
  }
}
let shown = null, computing = false, dirty = false, playing = false, asked = 0, drawn = null;
const meter = { frames: 0, rows: 0, since: 0, text: "", last: null };

async function start() {
  const sent = effective();
  const chosen = variants.reduce((set, v, i) => page.chosen.has(v.name) ? set | 1 << i : set, 0);
  const answer = await ask({ type: "start", values: settings.map(s => sent.values[s.name]), chosen });
  if (answer.type === "refused") {
    byId("status").textContent = answer.message;
    byId("status").className = "refused";
    return null;
  }
  byId("status").className = "";
  return new Run(sent, answer);
}
/** All rows anew; shown when they are there, or as they come if that takes long. */
async function compute() {
  computing = true;
  dirty = false;
  const begun = performance.now(), run = await start();
  for (const wanted = rowsWanted(); run && run.taken < wanted && !dirty && !playing;) {
    const answer = await ask({ type: "rows", n: Math.min(100, wanted - run.taken) });
    if (answer.taken === 0) break;
    run.add(answer, Infinity);
    if (performance.now() - begun > 200) shown = run;
  }
  if (run && run.taken > 0 && !playing) shown = run;
  if (run && !dirty) describe();
  computing = false;
}
async function play(on) {
  if (on === playing) return;
  playing = on;
  byId("play").setAttribute("aria-pressed", on);
  byId("play").textContent = on ? "Pause" : "Let rows arrive";
  if (!on) return describe();
  while (computing) await new Promise(requestAnimationFrame);
  Object.assign(meter, { frames: 0, rows: 0, since: performance.now(), text: "" });
  shown = await start();
  dirty = false;
  if (!shown) return play(false);
}
/** One order for rows a frame, and never more than four on their way. */
async function arrive() {
  const run = shown;
  ++asked;
  const answer = await ask({ type: "rows", n: Number(byId("pace").value) });
  --asked;
  if (run !== shown || !playing) return;
  if (answer.taken === 0) return play(false);
  run.add(answer, rowsWanted());
  meter.rows += answer.taken;
}
let frame = 0;
function eachFrame() {
  requestAnimationFrame(eachFrame);
  if (playing) {
    if (dirty && asked === 0) {
      dirty = false;
      start().then(run => { if (run) shown = run; });
    } else if (shown && asked < 4 && !dirty) arrive();
    ++meter.frames;
    const seconds = (performance.now() - meter.since) / 1000;
    if (seconds >= 10 || (meter.last === null && seconds >= 1 && !meter.text)) {
      meter.text = `${(meter.frames / seconds).toFixed(1)} frames and ${
        Math.round(meter.rows / seconds)} rows a second`;
      if (seconds >= 10) {
        meter.last = { seconds, frames: meter.frames / seconds, rows: meter.rows / seconds };
        Object.assign(meter, { frames: 0, rows: 0, since: performance.now() });
      }
      byId("meter").textContent = meter.text;
    }
  } else if (dirty && !computing) compute();
  if (shown && shown.taken > 0 && (drawn !== shown || drawn.drawnAt !== shown.taken)) {
    drawAll();
    if (!playing || ++frame % 12 === 0) tabulate();
    drawn = shown;
    drawn.drawnAt = shown.taken;
  }
}

// --- what is seen ---------------------------------------------------------------------------------------------------

const look = () => {
  const css = getComputedStyle(document.documentElement), get = name => css.getPropertyValue("--" + name).trim();
  return { soft: get("soft"), rule: get("rule"), page: get("page"), text: get("text"),
           colour: name => get(looks[name][0]), dash: name => looks[name][1] };
};
/** The three figures as specifications for plot(). */
function figures(now) {
  const run = shown, wanted = rowsWanted(), last = Math.max(run.taken, playing ? 2 : wanted);
  const x = [Math.max(1, run.taken - wanted + 1), Math.max(wanted, last)];
  const rows = Array.from({ length: run.digits[0].length }, (_, i) => run.first + i), lines = [], dots = [];
  const pLines = [], pRows = run.measured.map(m => m.row), eLines = [], crosses = [];
  const of = byId("spectrum-of").value, log = value => value > 0 ? Math.log10(value) : NaN;
  let low = Infinity, high = -Infinity;
  for (const m of run.measured) {
    const s = m.of[variants.length].spectrum;
    low = Math.min(low, log(s[run.d - 1]));
    high = Math.max(high, log(s[0]));
  }
  for (const m of run.measured)    // of variants up to four decades more
    for (const { spectrum } of m.of) {
      if (log(spectrum[run.d - 1]) > low - 4) low = Math.min(low, log(spectrum[run.d - 1]));
      if (log(spectrum[0]) < high + 4) high = Math.max(high, log(spectrum[0]));
    }
  [low, high] = Number.isFinite(low + high) ? [Math.floor(low) - 1, Math.ceil(high) + 1] : [-4, 4];
  variants.forEach(({ name }, v) => {
    if (!page.chosen.has(name)) return;
    const colour = now.colour(name), dash = now.dash(name), width = name === page.focus ? 3.2 : 1.7;
    lines.push({ rows, values: run.digits[v], colour, dash, width });
    pLines.push({ rows: pRows, values: run.measured.map(m => m.of[v].digits), colour, dash, width });
    const summary = run.summaries[v];
    for (const [row, ring] of [[summary[3], false], [summary[4], true]])
      if (row >= run.first) dots.push({ row, value: run.digits[v][row - run.first], colour, ring });
    const all = of === name, ends = of === "";
    if (!all && !ends) return;
    for (let i = 0; i < run.d; ++i) {
      if (ends && i > 0 && i < run.d - 1) continue;
      const values = run.measured.map(m => m.of[v].spectrum[i]);
      eLines.push({ rows: pRows, values: values.map(log), colour, dash, width: i === run.d - 1 ? width : 1 });
      values.forEach((value, k) => { if (value <= 0) crosses.push({ row: pRows[k], colour }); });
    }
  });
  for (const i of [0, run.d - 1])
    eLines.push({ rows: pRows, values: run.measured.map(m => log(m.of[variants.length].spectrum[i])),
                  colour: now.soft, dash: [1, 3], width: 1.5 });
  const top = Math.max(4, Math.ceil(run.sent.values.bits * 0.30103 + 1));
  return [{ x, y: [-1, top], lines, dots, limit: run.carried() },
          { x, y: [-1, top], lines: pLines, dots: [], limit: run.carried() },
          { x, y: [low, high], lines: eLines, dots: [], crosses, limit: Infinity, label: t => `10^${t}` }];
}
const canvases = ["digits", "covariance", "spectrum"];
function drawAll() {
  const now = look();
  figures(now).forEach((spec, i) => draw(byId(canvases[i]), spec, now));
}
const shortly = x => Number.isFinite(x) ? x.toFixed(1) : "none";
const hashOf = s => (s[11] >>> 0).toString(16).padStart(8, "0") + (s[10] >>> 0).toString(16).padStart(8, "0");
/** Digits of the certified answer: rounding of the data counts here. Null where it does not apply. */
function certifiedDigits(v) {
  const record = facts.records.find(r => r.name === page.record), s = shown.sent.values;
  if (!record || s.lambda !== record.lambda || s.prior !== record.prior || shown.taken !== page.model.rows ||
      s.outlier || s.silent || s.change) return null;
  let error = 0, size = 0;
  record.certified.forEach(([head, tail], i) => {
    error += ((shown.theta[v][i] - head) + ((v === variants.length ? shown.theta[v][shown.d + i] : 0) - tail)) ** 2;
    size += head ** 2;
  });
  return error === 0 ? 32 : -Math.log10(Math.sqrt(error / size));
}
function tabulate() {
  const run = shown, guarded = run.sent.values.guard !== 0, last = run.measured[run.measured.length - 1];
  const certified = certifiedDigits(variants.length) !== null, folder = document.documentElement.dataset.variants;
  const heads = ["variant", "digits of θ", ...(certified ? ["digits of the certified θ"] : []), "digits of P",
    "smallest eigenvalue of P", "P indefinite from row", "reported at row", "operations a row",
    ...(guarded ? ["guard: outliers, changes, windups, breakdowns, unusable"] : [])];
  byId("table").tHead.innerHTML = `<tr>${heads.map(h => `<th scope="col">${h}</th>`).join("")}</tr>`;
  byId("table").tBodies[0].innerHTML = variants.map(({ name }, v) => {
    if (!page.chosen.has(name)) return "";
    const s = run.summaries[v], least = last ? last.of[v].spectrum[run.d - 1] : NaN;
    const operations = facts.operations[name][run.d - 1].reduce((a, b) => a + b, 0);
    const cells = [shortly(s[1]), ...(certified ? [shortly(certifiedDigits(v))] : []), shortly(s[2]),
      Number.isFinite(least) ? least.toPrecision(3) : "none", s[3] || "–", s[4] || "–", operations,
      ...(guarded ? [[s[6], s[7], s[8], s[9], s[5]].join(", ")] : [])];
    const title = folder ? `<a href="${folder}${name}.html">${name}</a>` : name;
    return `<tr${s[3] || s[4] ? ' class="broken"' : ""}><th scope="row">${title}</th>` +
      cells.map(c => `<td>${c}</td>`).join("") + "</tr>";
  }).join("");
  const carried = Math.max(0, Math.floor(run.carried())), agreed = certifiedDigits(variants.length);
  byId("reference").textContent = `The reference is qr in 106 bits on the same rounded data: not certified. By its ` +
    `condition it carries about ${carried} digits; nothing is claimed beyond.` +
    (agreed === null ? "" : run.sent.values.bits === 53 ? ` With this record it agrees with the certified answer, ` +
      `computed when the page was built, in ${agreed.toFixed(1)} digits.` : ` In ${run.sent.values.bits} bits the ` +
      `rounded data themselves have the certified θ in ${agreed.toFixed(1)} digits.`) +
    (guarded ? " The reference is not given the outlier, which the guard should skip. What else a guard changes " +
      "(it caps P, and restarts) counts as lost digits." : "");
}
/** In a sentence, for all and for a screen reader. */
function describe() {
  const run = shown, s = run && run.summaries;
  if (!s) return;
  const stored = run.stored, notes = [...run.sent.notes];
  if (stored.forgetting !== run.sent.values.lambda && Math.abs(stored.forgetting - run.sent.values.lambda) > 5e-4)
    notes.push(`λ is stored as ${Number(stored.forgetting.toPrecision(6))}`);
  if (run.sent.values.guard > 0) {
    const { name, what } = guards[run.sent.values.guard - 1];
    notes.push(`guard ${name}: ${what}`);
  }
  if (run.sent.values.gain_error > -41 && variants.some(v => page.chosen.has(v.name) && !v.gainErrorApplies))
    notes.push("information and qr use no gain to update: no error there");
  const broken = variants.filter((v, i) => page.chosen.has(v.name) && s[i][3] > 0).map(v =>
    `${v.name} from row ${s[variants.indexOf(v)][3]}`);
  const best = variants.filter(v => page.chosen.has(v.name)).map(v => [s[variants.indexOf(v)][1], v.name])
    .filter(([d]) => Number.isFinite(d)).sort((a, b) => b[0] - a[0])[0];
  byId("status").textContent = `${run.taken} rows in ${words.format(run.sent.values)}. ` +
    (best ? `Most digits: ${best[1]}, ${best[0].toFixed(1)}. ` : "") +
    (broken.length ? `P indefinite: ${broken.join(", ")}.` : "P stays definite in all.") +
    (notes.length ? ` Note: ${notes.join("; ")}.` : "");
}
requestAnimationFrame(eachFrame);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { drawn = null; keys(); });
new ResizeObserver(() => { drawn = null; }).observe(document.body);
