// Controls, links, records and files of one's own.

function changed() {
  dirty = true;
  clearTimeout(changed.timer);
  changed.timer = setTimeout(() => history.replaceState(null, "", link()), 300);
  showCode();
}
function control(s) {
  const [group, label, reading] = words[s.name], slides = typeof reading === "function";
  const box = document.createElement(slides ? "div" : "label");
  if (!reading) {
    box.className = "switch";
    box.innerHTML = `<input type="checkbox" id="set-${s.name}"><span>${label}</span>`;
  } else if (Array.isArray(reading)) {
    box.className = "choice";
    box.innerHTML = `<span>${label}</span><select id="set-${s.name}">` +
      reading.map((w, i) => `<option value="${i}">${w}</option>`).join("") + "</select>";
  } else {
    box.className = "slider";
    box.innerHTML = `<label for="set-${s.name}">${label}</label><output for="set-${s.name}"></output>` +
      `<input type="range" id="set-${s.name}" min="${s.least}" max="${s.most}" step="${s.step}">`;
  }
  byId(group).append(box);
  box.querySelector("input, select").addEventListener("input", e => {
    page.values[s.name] = e.target.type === "checkbox" ? Number(e.target.checked) : Number(e.target.value);
    show(s);
    changed();
  });
}
/** The value in its control. */
function show(s) {
  const input = byId(`set-${s.name}`), v = page.values[s.name], reading = words[s.name][2];
  if (input.type === "checkbox") input.checked = v !== 0;
  else input.value = v;
  if (typeof reading !== "function") return;
  input.previousElementSibling.textContent = reading(v);
  input.setAttribute("aria-valuetext", reading(v));
}
function showAll() {
  settings.filter(s => words[s.name]).forEach(show);
  for (const { name } of variants) byId(`show-${name}`).checked = page.chosen.has(name);
  for (const name of ofMadeRows) byId(`set-${name}`).parentElement.hidden = page.record !== "";
  byId("record").value = page.record;
  if (page.focus) byId("code-variant").value = page.focus;
  const r = facts.records.find(of => of.name === page.record);
  byId("about-record").textContent = r ? `${r.what}. ${r.source}; ${r.licence}.` : "";
}
/** The keys: a line as in the figures. */
function keys() {
  const now = look();
  for (const { name } of variants)
    byId(`key-${name}`).innerHTML = `<svg viewBox="0 0 26 10" aria-hidden="true"><path d="M0 5H26" fill="none" ` +
      `stroke="${now.colour(name)}" stroke-width="3" stroke-dasharray="${now.dash(name).join(" ")}"/></svg>`;
}

// --- links ----------------------------------------------------------------------------------------------------------

function link() {
  const out = new URLSearchParams();
  for (const s of settings)
    if (words[s.name] && page.values[s.name] !== s.start) out.set(s.name, page.values[s.name]);
  if (page.chosen.size !== variants.length)
    out.set("variants", variants.map(v => v.name).filter(name => page.chosen.has(name)).join(","));
  if (page.focus) out.set("variant", page.focus);
  if (page.record && page.record !== "own") out.set("record", page.record);
  return `#${out}`;
}
function setAll(given, record = "") {
  for (const s of settings) {
    const r = facts.records.find(of => of.name === record), x = Number(given[s.name] ?? r?.[s.name] ?? s.start);
    const value = Number.isFinite(x) ? x : s.start, near = s.least + Math.round((value - s.least) / s.step) * s.step;
    page.values[s.name] = Number(Math.min(s.most, Math.max(s.least, near)).toFixed(6));
  }
}
async function follow(hash) {
  const given = Object.fromEntries(new URLSearchParams(hash.replace(/^#/, "")));
  const record = facts.records.some(r => r.name === given.record) ? given.record : "";
  const names = (given.variants || "").split(",").filter(name => variants.some(v => v.name === name));
  page.chosen = new Set(names.length ? names : variants.map(v => v.name));
  page.focus = variants.some(v => v.name === given.variant) ? given.variant : "";
  if (page.focus) page.chosen.add(page.focus);
  await choose(record, given);
}

// --- records and files ----------------------------------------------------------------------------------------------

/** Made rows (""), or a record of the page; its own settings where `given` has no others. */
async function choose(name, given) {
  const r = facts.records.find(of => of.name === name), kept = given || { ...page.values };
  if (r) {
    await ask({ type: "table", content: r.text });
    page.columns = null;
    await model(r);
  } else page.model = null;
  if (!given && r) kept.lambda = r.lambda, kept.prior = r.prior;
  page.record = name;
  setAll(kept, name);
  byId("model").hidden = true;
  byId("own-message").textContent = "";
  showAll();
  changed();
}
async function model(of) {
  const answer = await ask({ type: "model", model: of });
  if (answer.type === "no-model") return answer.message;
  page.model = answer;
  page.output = of.past > 0 || of.delays > 0 ? "y[k]" : "y";
  return "";
}
async function take(file) {
  await takeText(await file.slice(0, 1 << 26).text(), file.name);    // beyond the rows that are read
}
async function takeText(content, name) {
  if (playing) play(false);
  const answer = await ask({ type: "table", content });
  if (answer.type === "no-table") {
    byId("own-message").textContent = `${name}: ${answer.message}`;
    page.record = "";
    page.model = null;
    byId("model").hidden = true;
    showAll();
    return changed();
  }
  page.columns = answer.columns;
  const numbers = answer.columns.map((c, j) => [c, j]).filter(([c]) => c.missing >= 0);
  const output = numbers.length ? numbers[numbers.length - 1][1] : 0;
  byId("model").innerHTML = `<p>${escaped(name)}: ${answer.rows} rows${
    answer.rows === 20000 ? " (later ones are left out)" : ""}, ${answer.columns.length} columns</p>
<label class="choice"><span>Output</span><select id="own-output">${numbers.map(([c, j]) =>
    `<option value="${j}"${j === output ? " selected" : ""}>${escaped(c.name)}</option>`).join("")}</select></label>
<div class="inputs" role="group" aria-label="Inputs">${answer.columns.map((c, j) => `<label><input type="checkbox" ` +
    `value="${j}"${c.missing < 0 ? " disabled" : ""}> ${escaped(c.name)}${c.missing < 0 ? " (not numbers)"
      : c.missing > 0 ? ` (${c.missing} missing)` : ""}</label>`).join("")}</div>
<label class="choice"><span>Past outputs</span><select id="own-past">${[0, 1, 2, 3, 4].map(n =>
    `<option>${n}</option>`).join("")}</select></label>
<label class="choice"><span>Past inputs</span><select id="own-delays">${[0, 1, 2, 3].map(n =>
    `<option>${n}</option>`).join("")}</select></label>
<label class="switch"><input type="checkbox" id="own-constant" checked> a constant</label>`;
  const boxes = [...byId("model").querySelectorAll(".inputs input")];
  for (const box of boxes.filter(b => !b.disabled && Number(b.value) !== output).slice(0, 10)) box.checked = true;
  byId("model").hidden = false;
  byId("model").oninput = fromControls;
  await fromControls();
}
/** The model that the controls of one's own file describe. */
async function fromControls() {
  if (playing) play(false);
  const output = Number(byId("own-output").value), boxes = [...byId("model").querySelectorAll(".inputs input")];
  const inputs = boxes.filter(b => b.checked && Number(b.value) !== output).map(b => Number(b.value));
  const message = page.columns.every(c => c.missing < 0) ? "expected a column of numbers, found none"
    : await model({ output, inputs, past: Number(byId("own-past").value), delays: Number(byId("own-delays").value),
                    constant: byId("own-constant").checked });
  if (message) page.model = null;
  else page.output = page.columns[output].name + (page.output === "y[k]" ? "[k]" : "");
  page.record = message ? "" : "own";
  byId("own-message").textContent = message || `${page.model.rows} rows of ${page.model.d} parameters` +
    (page.model.skipped ? `; ${page.model.skipped} skipped, where a value is missing` : "") +
    ". Columns are divided by powers of two, which changes no digit.";
  showAll();
  byId("model").hidden = false;
  changed();
}

// --- saving ---------------------------------------------------------------------------------------------------------

function save(name, type, content) {
  const a = document.createElement("a");
  a.href = URL.createObjectURL(new Blob([content], { type }));
  a.download = name;
  a.click();
  setTimeout(() => URL.revokeObjectURL(a.href), 1000);
}
/** The first figures, with keys and settings. */
function svg(panels = 3) {
  const now = look(), W = 900, parts = [], names = variants.map(v => v.name).filter(n => page.chosen.has(n));
  const titles = ["Digits of theta", "Digits of P", "Eigenvalues of P"], heights = [320, 220, 220];
  let y = 40;
  figures(now).slice(0, panels).forEach((spec, i) => {
    const g = new SvgContext(20, y);
    plot(g, W - 40, heights[i], spec, now);
    parts.push(`<text x="20" y="${y - 8}" font-weight="600" fill="${now.text}">${titles[i]}</text>${g}`);
    y += heights[i] + 32;
  });
  names.forEach((name, i) => {
    const x = 20 + i % 5 * 175, at = y + Math.floor(i / 5) * 22;
    parts.push(`<path d="M${x} ${at - 4}h26" stroke="${now.colour(name)}" stroke-width="3" stroke-dasharray="${
      now.dash(name).join(" ")}"/><text x="${x + 32}" y="${at}" fill="${now.text}">${name}</text>`);
  });
  const s = shown.sent.values, H = y + 62;
  parts.push(`<text x="20" y="${y + 46}" fill="${now.soft}">${escaped(`${shown.taken} rows, ${words.format(s)}, λ = ${
    s.lambda}${page.record ? `, ${page.record}` : ""}${link() === "#" ? "" : `; ${link()}`}`)}</text>`);
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${W} ${H}" width="${W}" height="${H}" ` +
    `font-family="system-ui, 'DejaVu Sans', sans-serif" font-size="12"><rect width="${W}" height="${H}" ` +
    `fill="${now.page}"/>${parts.join("\n")}</svg>\n`;
}
function csv() {
  const run = shown, used = variants.map((v, i) => [v.name, i]).filter(([name]) => page.chosen.has(name));
  const heads = used.flatMap(([n]) => [`${n} digits of theta`, `${n} digits of P`, `${n} smallest eigenvalue of P`,
                                       `${n} largest eigenvalue of P`]);
  const measured = new Map(run.measured.map(m => [m.row, m])), cell = x => Number.isFinite(x) ? x : "";
  const lines = run.digits[0].map((_, i) => {
    const m = measured.get(run.first + i);
    return [run.first + i, ...used.flatMap(([, v]) => [cell(run.digits[v][i]), ...(m ? [m.of[v].digits,
      m.of[v].spectrum[run.d - 1], m.of[v].spectrum[0]].map(cell) : ["", "", ""])])].join(",");
  });
  return [["row", ...heads].join(","), ...lines].join("\n") + "\n";
}
async function copied(button, content) {
  const before = button.textContent;
  try {
    await navigator.clipboard.writeText(content);
  } catch {    // from a file, or without leave
    const area = document.createElement("textarea");
    area.value = content;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
    button.focus();
  }
  button.textContent = "Copied";
  setTimeout(() => { button.textContent = before; }, 1500);
}
function program(language) {
  const { values: v } = effective(), d = page.model ? page.model.d : v.parameters;
  return programOf(language, { variant: byId("code-variant").value, bits: v.bits, exponents: v.exponents,
    rounding: v.rounding, lambda: v.lambda, prior: 2 ** v.prior, guard: v.guard > 0 ? guards[v.guard - 1] : null,
    names: page.model ? page.model.names : null, d,
    scales: page.model ? page.model.scales.slice(0, d) : new Array(d).fill(1),
    output: page.model ? page.output : "y" });
}
function showCode() {
  byId("code").textContent = program(byId("language").value);
}

// --- begin ----------------------------------------------------------------------------------------------------------

async function begin(ready) {
  ({ settings, guards, variants, parametersMost } = ready);
  words.guard[2].push(...guards.map(g => g.name));
  settings.filter(s => words[s.name]).forEach(control);
  for (const { name } of variants) {
    const box = document.createElement("label");
    box.innerHTML = `<input type="checkbox" id="show-${name}"><span id="key-${name}"></span><span>${name}</span>`;
    byId("variants").append(box);
    box.firstChild.addEventListener("input", e => {
      page.chosen[e.target.checked ? "add" : "delete"](name);
      changed();
    });
    byId("code-variant").append(new Option(name, name, name === "ud", name === "ud"));
    byId("spectrum-of").append(new Option(`${name}, all`, name));
  }
  byId("spectrum-of").prepend(new Option("all variants, ends", "", true, true));
  for (const r of facts.records) byId("record").append(new Option(r.name, r.name));
  byId("record").append(new Option("your file", "own"));
  for (const [label, values] of Object.entries(stories)) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = label;
    button.onclick = () => choose("", values);
    byId("stories").append(button);
  }
  keys();
  byId("record").oninput = e => e.target.value === "own" ? byId("file").click() || showAll() : choose(e.target.value);
  byId("spectrum-of").oninput = () => { drawn = null; };
  byId("play").onclick = () => play(!playing);
  byId("copy-link").onclick = e => copied(e.target, location.href.replace(/#.*$/, "") + link());
  byId("save-svg").onclick = () => save("rlslab.svg", "image/svg+xml", svg());
  byId("save-csv").onclick = () => save("rlslab.csv", "text/csv", csv());
  byId("reset").onclick = () => follow("");
  byId("language").oninput = byId("code-variant").oninput = showCode;
  byId("copy-code").onclick = e => copied(e.target, byId("code").textContent);
  byId("file").oninput = e => e.target.files[0] && take(e.target.files[0]);
  addEventListener("dragover", e => { e.preventDefault(); document.body.classList.add("dropping"); });
  addEventListener("dragleave", e => e.relatedTarget || document.body.classList.remove("dropping"));
  addEventListener("drop", e => {
    e.preventDefault();
    document.body.classList.remove("dropping");
    if (e.dataTransfer.files[0]) take(e.dataTransfer.files[0]);
  });
  addEventListener("hashchange", () => follow(location.hash));
  await follow(location.hash);
  document.body.dataset.ready = "yes";
}
{
  const folder = document.documentElement.dataset.variants;
  byId("home").hidden = !folder;
  byId("home").href = `${folder}../index.html`;
  const bytes = atob(byId("module").textContent), packed = Uint8Array.from(bytes, c => c.charCodeAt(0));
  worker.postMessage({ type: "begin", packed }, [packed.buffer]);
}
