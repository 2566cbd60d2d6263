// What is wider than the page can be scrolled by keys.
function reach() {
  for (const wide of document.querySelectorAll("pre, .math, .table-wrapper, .answer, p:has(> img)"))
    if (wide.scrollWidth > wide.clientWidth) wide.tabIndex = 0;
}
for (const event of ["DOMContentLoaded", "load", "resize", "click", "toggle"])
  window.addEventListener(event, reach, true);

// The form of "Which variant?": what it knows is the recorded data in the page.
document.addEventListener("DOMContentLoaded", () => {
  const place = document.getElementById("picker"), data = document.getElementById("picker-data");
  if (!place || !data) return;
  const { machine, variants, map } = JSON.parse(data.textContent);
  const options = list => list.map(([value, text]) => `<option value="${value}">${text}</option>`).join("");
  const choice = (name, label, list) =>
    `<label>${label} <select id="pick-${name}">${options(list)}</select></label>`;
  const number = (name, label, value) =>
    `<label>${label} <input id="pick-${name}" type="number" min="0" step="any" value="${value}"></label>`;
  place.innerHTML = number("d", "Parameters", 4) + number("kappa", "Condition number of the rows", 100) +
    choice("basis", "It comes from", [["rotated", "correlated columns"], ["units", "units of the columns"]]) +
    choice("word", "Word", [[53, "double, 53 bits"], [24, "float, 24 bits"], [11, "binary16, 11 bits"],
      [8, "bfloat16, 8 bits"]]) +
    choice("lambda", "Forgetting", [["rows", "none"], ["memory", "with a forgetting factor λ"]]) +
    number("rows", "Rows; or, with λ, memory 1/(1 − λ)", 100) +
    choice("prior", "Prior", [["some", "P₀ = c² I"], ["none", "none at all"]]) +
    number("c2", "c² times the mean square of a row", 10000) +
    choice("where", "Where", [["x86", "C++, C, Python on x86-64"], ["m3", "Cortex-M3"], ["m4f", "Cortex-M4F"],
      ["m7", "Cortex-M7"], ["sparse", "C++, sparse rows"]]) +
    `<div class="answer" aria-live="polite"></div>`;
  const value = name => document.getElementById(`pick-${name}`).value;
  const nearest = (list, far) => list.reduce((a, b) => a === undefined || far(b) < far(a) ? b : a, undefined);
  const positive = (name, otherwise) => Number(value(name)) > 0 ? Number(value(name)) : otherwise;
  const kappa = () => Math.max(1, positive("kappa", 1));
  // the nearest cell of the map: its place in words, digits of the best form, digits that each form loses to it
  function cell() {
    const bits = value("word"), word = { 53: "double", 24: "float", 11: "11 bits" }[bits];
    if (!word || value("prior") === "none" || value("where") === "sparse") return undefined;
    const count = regime => Math.log(regime.match(/\d+(?= rows$|$)/)[0] / positive("rows", 100));
    const regime = nearest(Object.keys(map.lost).filter(r => r.startsWith(word) && r.includes(value("lambda"))),
      r => Math.abs(count(r)));
    const far = (e, x) => Math.abs(e - Math.log2(x) / bits);    // exponents of 1/u
    const near = (of, x) => nearest(Object.keys(of), e => far(e, x));
    const priors = map.lost[regime][value("basis")], prior = near(priors, positive("c2", 1));
    const condition = near(priors[prior], kappa()), [theta, worst, P, ...lost] = priors[prior][condition].split(",");
    const written = e => Number(Math.pow(2, bits * e).toPrecision(2));
    const outside = Math.abs(count(regime)) > Math.log(10) || far(prior, positive("c2", 1)) > 0.25 ||
      far(condition, kappa()) > 0.125;
    const from = value("basis") === "units" ? "units of the columns" : "correlated columns";
    return { place: `${regime.replace(/ (?=memory|\d+ rows)/, ", ")}, ${from}, c² = ${written(prior)}, ` +
      `κ = ${written(condition)}`, outside, best: [theta, worst, P].map(x => Number(x).toFixed(1)),
      lost: Object.fromEntries(map.forms.map((form, i) => [form, lost[i]])) };
  }
  // [rank, digits lost, words]: 0 good, 1 less good, 2 not known, 3 no
  function verdict(v, here) {
    const no = words => [3, 0, `no: ${words}`], unknown = words => [2, 0, `${words}: ask compare`];
    if (v.sparse !== (value("where") === "sparse")) return no(v.sparse ? "for sparse rows" : "for dense rows");
    if (value("prior") === "none" && !v.free) return no("needs a prior");
    if (value("lambda") === "memory" && v.asymmetric) return no("its asymmetry grows with forgetting");
    if (here) {
      const lost = here.lost[v.name];
      if (lost === undefined) return unknown("not on the map");
      return lost === "lost" ? no("P indefinite") : [lost > 0.5 ? 1 : 0, Number(lost), Number(lost).toFixed(1)];
    }
    if (!v.slope) return unknown("not in that study");
    if (!v.constant) return unknown(`${v.slope} bits for each doubling of the condition number`);
    // the law was measured from kappa = 2^8 on; below it the lines are flat, and no higher
    const doublings = Math.log2(kappa()), bits = Number(value("word"));
    const least = Math.ceil(v.slope * doublings + v.constant[0]);
    const most = Math.ceil(v.slope * Math.max(8, doublings) + v.constant[1]);
    if (bits < least) return no(`needs ${least} bits and more`);
    return bits < most ? [1, 0, `near its limit, ${least} to ${most} bits`] : [0, 0, `needs at most ${most} bits`];
  }
  function answer() {
    const d = Math.max(1, Number(value("d")) || 1), board = value("where").startsWith("m"), here = cell();
    const word = { 53: "double", 24: "float" }[value("word")];
    // [what an update costs on this platform in this word, at the measured size that is nearest to d]
    function cost(v) {
      const sizes = v.cost[value("where")]?.[word] ?? {};
      const size = nearest(Object.keys(sizes), size => Math.abs(Math.log(size / d)));
      return size === undefined ? [] : [sizes[size], size];
    }
    const rows = variants.map(v => [...verdict(v, here), cost(v)[0], v])
      .sort((a, b) => a[0] - b[0] || (a[0] && a[1] - b[1]) || (a[3] ?? 1e9) - (b[3] ?? 1e9));
    const shown = v => `${cost(v)[0]}${v.later ? "*" : ""}${cost(v)[1] == d ? "" : ` (d = ${cost(v)[1]})`}`;
    const count = rank => rows.filter(r => r[0] === rank).length;
    const unit = !word ? "No times were measured in this word" : (board ?
      `Instructions of an update in ${word}, at -O2 (<a href="docs/embedded.html#what-it-costs">measured</a>)` :
      `Nanoseconds of an update in ${word} on ${machine}`) + ", at the measured number of parameters nearest to yours";
    const found = here ? `The nearest cell of <a href="docs/map.html">the map of winners</a> (4 parameters):
      ${here.place}.${here.outside ? " <strong>Your data lie outside the map: ask compare.</strong>" : ""}
      There the best form keeps ${here.best[0]} digits of theta, ${here.best[1]} of its worst component and
      ${here.best[2]} of P.
      Half a digit at most, in any of the three, is lost by ${count(0)} of ${map.forms.length} forms (medians of 11
      runs). <a href="docs/map.html#where-the-rules-end">Not for</a> a plant at rest when the filter starts, rows that
      repeat, raw counts${value("word") === "11" ? ", binary16's exponents (take <code>inverse_qr</code>)" : ""}.` :
      `${count(0)} variants keep three digits of theta and P and ${count(1)} may, by the law of
      <a href="studies/choose.html">the study choose</a> (4 parameters, P0 = κ² I, graded rows, κ of 256 and more).`;
    place.querySelector(".answer").innerHTML = `<p>${found} ${unit}; *: without theta; –: not measured.</p>
      <table class="docutils"><thead><tr>
      <th>variant</th><th>${board ? "instructions" : "ns"}</th><th>${here ? "digits lost" : "verdict"}</th></tr></thead>
      <tbody>` + rows.map(([rank, , words, spent, v]) =>
      `<tr class="${rank === 3 ? "no" : ""}"><td><a href="variants/${v.name}.html"><code>${v.name}</code></a></td>
      <td class="cost">${spent === undefined ? "–" : shown(v)}</td><td>${words}</td>
      </tr>`).join("") + "</tbody></table>";
  }
  place.addEventListener("input", answer);
  answer();
});
