// The library in a worker: it takes settings, tables and orders for rows, and answers with numbers.
let x;
const doubles = (at, n) => new Float64Array(x.memory.buffer, at, n);
const text = at => {
  const bytes = new Uint8Array(x.memory.buffer);
  let end = at;
  while (bytes[end]) ++end;
  return new TextDecoder().decode(bytes.slice(at, end));
};
const list = (n, of) => Array.from({ length: n }, (_, i) => of(i));

async function begin(packed) {
  const bytes = new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  // What a program would print where memory ends; the page needs none of it.
  const nothing = new Proxy({}, { get: () => () => 0 });
  const { instance } = await WebAssembly.instantiate(await bytes, { env: nothing, wasi_snapshot_preview1: nothing });
  x = instance.exports;
  if (x._initialize) x._initialize();
  postMessage({
    type: "ready",
    settings: list(x.settings(), i => {
      const [least, most, step, start] = doubles(x.setting_range(i), 4);
      return { name: text(x.setting_name(i)), least, most, step, start };
    }),
    guards: list(x.guards(), i => ({ name: text(x.guard_text(i, 0)), constant: text(x.guard_text(i, 1)),
                                     what: text(x.guard_text(i, 2)) })),
    variants: list(x.variants(), v => ({ name: text(x.variant_name(v)),
                                         gainErrorApplies: x.gain_error_applies(v) !== 0 })),
    parametersMost: x.parameters_most(),
  });
}

const answers = {
  start({ id, values, chosen }) {
    doubles(x.values(), values.length).set(values);
    const d = x.start(chosen);
    return d < 0 ? { type: "refused", id, message: text(x.message()) }
                 : { type: "started", id, d, forgetting: x.stored_forgetting(), prior: x.stored_prior() };
  },
  rows({ id, n }) {
    const variants = x.variants(), width = 1 + (variants + 1) * (1 + x.parameters_most()), out = [], measures = [];
    let taken = 0;
    while (taken < n) {
      const now = x.advance(Math.min(100, n - taken));
      if (now === 0) break;
      out.push(list(variants, v => doubles(x.digits(v), now).slice()));
      measures.push(doubles(x.measures(), x.measured() * width).slice());
      taken += now;
    }
    return { type: "rows", id, taken, digits: out, measures, width,
             summaries: list(variants + 1, v => Array.from(doubles(x.summary(v), 12))),
             theta: list(variants + 1, v => Array.from(doubles(x.theta(v), 2 * x.parameters_most()))) };
  },
  table({ id, content }) {
    const bytes = new TextEncoder().encode(content), at = x.text(bytes.length);
    new Uint8Array(x.memory.buffer).set(bytes, at);
    const columns = x.read_table(bytes.length);
    if (columns < 0) return { type: "no-table", id, message: text(x.message()) };
    return { type: "table", id, rows: x.table_rows(),
             columns: list(columns, j => ({ name: text(x.column_name(j)), missing: x.column_missing(j) })) };
  },
  model({ id, model }) {
    for (const j of model.inputs) x.add_input(j);
    const d = x.make_rows(model.output, model.past, model.delays, model.constant ? 1 : 0);
    if (d < 0) return { type: "no-model", id, message: text(x.message()) };
    return { type: "model", id, d, rows: x.rows_made(), skipped: x.rows_skipped(),
             names: list(d, i => text(x.regressor_name(i))), scales: list(d + 1, i => x.scale(i)) };
  },
};
const failed = e => postMessage({ type: "failed", message: e.message });
onmessage = ({ data }) =>
    data.type === "begin" ? begin(data.packed).catch(failed) : postMessage(answers[data.type](data));
