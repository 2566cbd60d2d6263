// Draws what the program worked out: formulas, figures, tables. Nothing is computed here.
'use strict';
const data = JSON.parse(document.getElementById('data').textContent);

for (const box of document.querySelectorAll('.formula'))
  if (window.temml) temml.render(box.dataset.tex, box, { displayMode: true, throwOnError: false });

const digits = x => Number.isFinite(x) ? (x !== 0 && (Math.abs(x) < 1e-3 || Math.abs(x) >= 1e6) ? x.toExponential(4) : String(+x.toPrecision(6))) : String(x);
const isNarrow = () => window.innerWidth <= 760;

function mark(curve) {
  const NS = 'http://www.w3.org/2000/svg';
  const svg = document.createElementNS(NS, 'svg');
  svg.setAttribute('viewBox', '0 0 34 12');
  const open = curve.mark.endsWith('-open');
  const shape = curve.mark.replace('-open', '');
  const paths = { circle: 'M17 2a4 4 0 1 0 .01 0z', square: 'M13 2h8v8h-8z', diamond: 'M17 1l5 5-5 5-5-5z', 'triangle-up': 'M17 1l5 9h-10z',
    'triangle-down': 'M17 11l5-9h-10z', star: 'M17 .5l1.5 3.8 4 .3-3.1 2.6 1 4-3.4-2.2-3.4 2.2 1-4-3.1-2.6 4-.3z',
    cross: 'M15.4 1.5h3.2v3h3v3h-3v3h-3.2v-3h-3v-3h3z', x: 'M13 3.5l1.8-1.8L17 4l2.2-2.3L21 3.5 18.8 6 21 8.5l-1.8 1.8L17 8l-2.2 2.3L13 8.5 15.2 6z' };
  svg.innerHTML = `<path d="M0 6H34" stroke="${curve.colour}" stroke-width="1.8" ${curve.dashed ? 'stroke-dasharray="5 3"' : ''}/>` +
    (shape && curve.marks !== false ? `<path d="${paths[shape]}" fill="${open ? '#fff' : curve.colour}" stroke="${curve.colour}"/>` : '');
  return svg;
}

function traces(panel, figure, hidden) {
  const out = [];
  for (const c of panel.curves) {
    const shown = !hidden.has(c.name);
    if (c.low) {
      const band = { x: [...c.x, ...[...c.x].reverse()], y: [...c.high, ...[...c.low].reverse()], fill: 'toself', fillcolor: c.colour + '1f',
        line: { width: 0 }, mode: 'lines', hoverinfo: 'skip', showlegend: false, visible: shown };
      out.push(band);
    }
    out.push({ x: c.x, y: c.y, name: c.name, mode: c.marks === false ? 'lines' : c.line === false ? 'markers' : 'lines+markers', visible: shown, showlegend: false,
      line: { color: c.colour, width: 1.6, dash: c.dashed ? 'dash' : 'solid' },
      marker: { color: c.colour, symbol: c.mark, size: 7, line: { width: 1.4, color: c.colour } },
      text: c.x.map((x, i) => `<b>${c.name}</b><br>${figure.x}: ${digits(x)}<br>${figure.y || c.name}: ${digits(c.y[i])}` +
        (c.low ? `<br>from ${digits(c.low[i])} to ${digits(c.high[i])}` : '')), hoverinfo: 'text' });
  }
  for (const g of panel.guides)
    out.push({ x: g.x, y: g.y, name: g.name, mode: 'lines', visible: !hidden.has(g.name), showlegend: false, hoverinfo: 'name',
      line: { color: g.colour, width: 1.5, dash: 'dot' } });
  return out;
}

// Cells meet halfway between their places; the tooltips are at the places.
function edges(places, log) {
  const at = log ? places.map(Math.log10) : places, back = v => log ? 10 ** v : v, out = new Map();
  places.forEach((place, i) => {
    const before = i > 0 ? (at[i] - at[i - 1]) / 2 : (at[1] - at[0]) / 2 || 0.5, after = i + 1 < at.length ? (at[i + 1] - at[i]) / 2 : before;
    out.set(place, [back(at[i] - before), back(at[i] + after)]);
  });
  return out;
}
const shades = [[247, 247, 247], [146, 197, 222], [5, 48, 97]];
function shade(value) {
  if (!Number.isFinite(value)) return '#fff';
  const v = 2 * Math.max(0, Math.min(1, value)), i = Math.min(1, Math.floor(v));
  return `rgb(${shades[i].map((c, k) => Math.round(c + (shades[i + 1][k] - c) * (v - i))).join(',')})`;
}
function cellTraces(panel, figure) {
  const c = panel.curves[0];
  return [{ x: c.x, y: c.row, mode: 'markers', showlegend: false, marker: { symbol: 'square', size: 9, opacity: 0 },
    text: c.x.map((x, i) => `<b>${figure.series} ${c.row[i]}</b><br>${figure.x}: ${digits(x)}<br>${figure.y}: ${digits(c.y[i])}`), hoverinfo: 'text' }];
}
function cellShapes(panel, figure) {
  const c = panel.curves[0], columns = edges([...new Set(c.x)].sort((a, b) => a - b), figure.logX), rows = [...new Set(c.row)];
  return c.x.map((x, i) => ({ type: 'rect', layer: 'below', x0: columns.get(x)[0], x1: columns.get(x)[1], y0: rows.indexOf(c.row[i]) - 0.5, y1: rows.indexOf(c.row[i]) + 0.5,
    fillcolor: shade(c.y[i]), line: { width: 0.5, color: '#fff' } }));
}

function range(figure, which) {
  let least = Infinity, most = -Infinity;
  for (const panel of figure.panels) for (const c of [...panel.curves, ...(which === 'x' ? panel.guides : [])])
    for (const v of (which === 'x' ? c.x : [...(c.low || c.y), ...(c.high || c.y)])) { least = Math.min(least, v); most = Math.max(most, v); }
  const log = which === 'x' ? figure.logX : figure.logY;
  if (!(least <= most)) return undefined;
  if (log) { least = Math.log10(least); most = Math.log10(most); }
  const pad = 0.05 * (most - least || 1);
  return [least - pad, most + pad];
}

function axis(title, log, span) {
  const wide = log && span && span[1] - span[0] > 3;
  return { title: { text: title, font: { size: 13 } }, type: log ? 'log' : undefined, exponentformat: 'power', showline: true, mirror: true, linecolor: '#888', ticks: 'outside',
    gridcolor: '#e8e8e8', zeroline: false, range: span, automargin: true, nticks: 8, ...(wide ? { dtick: Math.ceil((span[1] - span[0]) / 8) } : log && span && span[1] - span[0] < 1.6 ? { dtick: 'D2', tickangle: 0 } : {}) };
}

function draw(box) {
  const figure = data.figures[box.dataset.figure];
  if (!window.Plotly || !figure) return;
  box.textContent = '';
  const hidden = new Set();
  const panels = document.createElement('div');
  panels.className = 'panels' + (figure.panels.length === 1 ? ' one' : figure.cells && figure.panels.length > 4 ? ' many' : '');
  const spanX = figure.square ? undefined : range(figure, 'x'), spanY = figure.cells || figure.square || figure.ownY ? undefined : range(figure, 'y');
  const plots = figure.panels.map(panel => {
    const cell = document.createElement('div');
    cell.className = 'panel';
    if (panel.name) { const h = document.createElement('h3'); h.textContent = panel.name; cell.append(h); }
    const plot = document.createElement('div');
    cell.append(plot);
    panels.append(cell);
    return [plot, panel];
  });
  const redraw = () => {
    for (const [plot, panel] of plots)
      Plotly.react(plot, figure.cells ? cellTraces(panel, figure) : traces(panel, figure, hidden),
        { shapes: figure.cells ? cellShapes(panel, figure) : [], height: figure.panels.length === 1 ? 470 : 360, margin: { l: 66, r: 12, t: 14, b: 52 }, font: { family: 'system-ui, sans-serif', size: 12, color: '#1a1a1a' },
          hovermode: 'closest', paper_bgcolor: '#fff', plot_bgcolor: '#fff', xaxis: axis(figure.x, figure.logX, spanX),
          yaxis: figure.cells ? { title: { text: figure.series, font: { size: 13 } }, type: 'category', automargin: true, showline: true, mirror: true, linecolor: '#888' } : { ...axis(figure.y, figure.logY, spanY), ...(figure.square ? { scaleanchor: 'x' } : {}) } },
        { responsive: true, displayModeBar: false });
  };
  if (!figure.cells) {
    const legend = document.createElement('div');
    legend.className = 'legend';
    const names = new Map();
    for (const panel of figure.panels) for (const c of [...panel.curves, ...panel.guides]) if (!names.has(c.name)) names.set(c.name, c);
    const buttons = new Map();
    const show = () => { for (const [name, b] of buttons) b.setAttribute('aria-pressed', String(!hidden.has(name))); redraw(); };
    for (const [name, curve] of names) {
      const button = document.createElement('button');
      button.append(mark(curve), name);
      button.title = 'click: hide or show; double-click: this one alone';
      button.onclick = () => { hidden.has(name) ? hidden.delete(name) : hidden.add(name); show(); };
      button.ondblclick = () => { const alone = hidden.size === names.size - 1 && !hidden.has(name); hidden.clear();
        if (!alone) for (const other of names.keys()) if (other !== name) hidden.add(other); show(); };
      buttons.set(name, button);
      legend.append(button);
    }
    box.append(legend);
    for (const [name, b] of buttons) b.setAttribute('aria-pressed', 'true');
  }
  if (figure.cells) {
    const scale = document.createElement('div');
    scale.className = 'legend';
    scale.innerHTML = `<span>0</span><span class="scale"></span><span>1&ensp;${figure.y}</span>`;
    box.append(scale);
  }
  box.append(panels);
  redraw();
  const exports = document.createElement('div');
  exports.className = 'exports';
  for (const format of ['svg', 'png']) {
    const button = document.createElement('button');
    button.textContent = format.toUpperCase();
    button.onclick = () => plots.forEach(([plot], i) =>
      Plotly.downloadImage(plot, { format, filename: figure.name + (plots.length > 1 ? '-' + (i + 1) : ''), width: 900, height: 560, scale: format === 'png' ? 2 : 1 }));
    exports.append(button);
  }
  box.append(exports);
}

// A figure is drawn when it comes near the window, or all of them before printing.
const boxes = [...document.querySelectorAll('.plot')];
const near = new IntersectionObserver(entries => {
  for (const e of entries) if (e.isIntersecting) { near.unobserve(e.target); draw(e.target); }
}, { rootMargin: '800px' });
boxes.forEach(box => near.observe(box));
window.addEventListener('beforeprint', () => boxes.filter(b => !b.querySelector('.panels')).forEach(draw));

for (const details of document.querySelectorAll('details.table'))
  details.addEventListener('toggle', () => {
    const place = details.querySelector('.scroll');
    if (!details.open || place.firstChild) return;
    const lines = data.tables[details.dataset.table].trimEnd().split('\n').map(line => line.split(','));
    const table = document.createElement('table');
    const add = (cells, tag) => { const row = table.insertRow(); for (const text of cells) { const c = document.createElement(tag); c.textContent = text; row.append(c); } };
    add(lines[0], 'th');
    lines.slice(1).forEach(cells => add(cells, 'td'));
    place.append(table);
    if (lines.length - 1 < +place.dataset.rows) place.append(`the first ${lines.length - 1} rows`);
  });
