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
  const { machine, variants } = JSON.parse(data.textContent);
  const options = list => list.map(([value, text]) => `<option value="${value}">${text}</option>`).join("");
  const choice = (name, label, list) =>
    `<label>${label} <select id="pick-${name}">${options(list)}</select></label>`;
  const number = (name, label, value) =>
    `<label>${label} <input id="pick-${name}" type="number" min="1" step="any" value="${value}"></label>`;
  place.innerHTML = number("d", "Parameters", 4) + number("kappa", "Condition number of the rows", 100) +
    choice("word", "Word", [[53, "double, 53 bits"], [24, "float, 24 bits"], [11, "binary16, 11 bits"],
      [8, "bfloat16, 8 bits"]]) +
    choice("lambda", "Forgetting", [["none", "none"], ["some", "some"]]) +
    choice("prior", "Prior", [["some", "there is one"], ["none", "none at all"]]) +
    choice("where", "Where", [["x86", "C++, C, Python on x86-64"], ["m3", "Cortex-M3"], ["m4f", "Cortex-M4F"],
      ["m7", "Cortex-M7"], ["sparse", "C++, sparse rows"]]) +
    `<div class="answer" aria-live="polite"></div>`;
  const value = name => document.getElementById(`pick-${name}`).value;
  // [rank, words]: 0 enough bits, 1 near the limit, 2 not known, 3 no
  function verdict(v, bits, doublings) {
    if (v.sparse !== (value("where") === "sparse")) return [3, v.sparse ? "for sparse rows" : "for dense rows"];
    if (value("prior") === "none" && !v.free) return [3, "needs a prior"];
    if (value("lambda") === "some" && v.asymmetric) return [3, "its asymmetry grows with forgetting"];
    if (!v.slope) return [2, "not in that study: ask compare"];
    if (!v.constant) return [2, `${v.slope} bits for each doubling of the condition number: ask compare`];
    // the law was measured from kappa = 2^8 on; below it the lines are flat, and no higher
    const least = Math.ceil(v.slope * doublings + v.constant[0]);
    const most = Math.ceil(v.slope * Math.max(8, doublings) + v.constant[1]);
    if (bits < least) return [3, `needs ${least} bits and more`];
    return bits < most ? [1, `near its limit, ${least} to ${most} bits`] : [0, `needs at most ${most} bits`];
  }
  function answer() {
    const d = Math.max(1, Number(value("d")) || 1), board = value("where").startsWith("m");
    const word = { 53: "double", 24: "float" }[value("word")];
    // [what an update costs on this platform in this word, at the measured size that is nearest to d]
    function cost(v) {
      const sizes = v.cost[value("where")]?.[word] ?? {}, far = size => Math.abs(Math.log(size / d));
      const size = Object.keys(sizes).reduce((a, b) => a === undefined || far(b) < far(a) ? b : a, undefined);
      return size === undefined ? [] : [sizes[size], size];
    }
    const doublings = Math.log2(Math.max(1, Number(value("kappa")) || 1));
    const rows = variants.map(v => [...verdict(v, Number(value("word")), doublings), cost(v)[0], v])
      .sort((a, b) => a[0] - b[0] || (a[2] ?? 1e9) - (b[2] ?? 1e9));
    const shown = v => `${cost(v)[0]}${v.later ? "*" : ""}${cost(v)[1] == d ? "" : ` (d = ${cost(v)[1]})`}`;
    const count = rank => rows.filter(r => r[0] === rank).length;
    const unit = !word ? "No times were measured in this word" : (board ?
      `Instructions of an update in ${word}, at -O2 (<a href="docs/embedded.html#what-it-costs">measured</a>)` :
      `Nanoseconds of an update in ${word} on ${machine}`) + ", at the measured number of parameters nearest to yours";
    place.querySelector(".answer").innerHTML = `<p>${count(0)} variants keep three digits of theta and P and
      ${count(1)} may, by the law of
      <a href="studies/choose.html">the study choose</a> (4 parameters, P0 = κ² I, graded rows, κ of 256 and more).
      ${unit}; *: without theta; –: not measured.</p>
      <table class="docutils"><thead><tr>
      <th>variant</th><th>${board ? "instructions" : "ns"}</th><th>verdict</th></tr></thead><tbody>` +
      rows.map(([rank, words, spent, v]) =>
      `<tr class="${rank === 3 ? "no" : ""}"><td><a href="variants/${v.name}.html"><code>${v.name}</code></a></td>
      <td class="cost">${spent === undefined ? "–" : shown(v)}</td>
      <td>${rank === 3 ? "no: " : ""}${words}</td>
      </tr>`).join("") + "</tbody></table>";
  }
  place.addEventListener("input", answer);
  answer();
});
