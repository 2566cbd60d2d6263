// Figures, drawn by one text on a canvas and into an SVG.

/** The part of a canvas's context that the figures use, as SVG. */
class SvgContext {
  constructor(x, y) { Object.assign(this, { x, y, parts: [], d: "", dash: [], globalAlpha: 1, textAlign: "left" }); }
  beginPath() { this.d = ""; }
  moveTo(x, y) { this.d += `M${x.toFixed(1)} ${y.toFixed(1)}`; }
  lineTo(x, y) { this.d += `L${x.toFixed(1)} ${y.toFixed(1)}`; }
  arc(x, y, r) { this.d += `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`; }
  setLineDash(dash) { this.dash = dash; }
  stroke() {
    this.parts.push(`<path d="${this.d}" fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}"` +
      ` stroke-dasharray="${this.dash.join(" ")}" opacity="${this.globalAlpha}"/>`);
  }
  fill() { this.parts.push(`<path d="${this.d}" fill="${this.fillStyle}" opacity="${this.globalAlpha}"/>`); }
  fillRect(x, y, w, h) {
    this.parts.push(`<rect x="${x}" y="${y}" width="${w}" height="${h}" fill="${this.fillStyle}"` +
      ` opacity="${this.globalAlpha}"/>`);
  }
  fillText(words, x, y) {
    const anchor = { left: "start", center: "middle", right: "end" }[this.textAlign];
    this.parts.push(`<text x="${x.toFixed(1)}" y="${y.toFixed(1)}" text-anchor="${anchor}" fill="${this.fillStyle}">` +
      `${escaped(words)}</text>`);
  }
  toString() { return `<g transform="translate(${this.x} ${this.y})">${this.parts.join("\n")}</g>`; }
}
const escaped = words => String(words).replace(/[&<>"]/g, c => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;",
                                                                 '"': "&quot;" })[c]);

/** Round numbers from a to b, n at most. */
function ticks(a, b, n) {
  const rough = (b - a) / n, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map(s => s * power).find(s => s >= rough) || 1, out = [];
  for (let t = Math.ceil(a / step) * step; t <= b + step * 1e-9; t += step) out.push(Math.round(t / step) * step);
  return out;
}

/** Lines over rows. spec: x, y: [from, to]; lines: {rows, values, colour, dash, width}; dots: {row, value, colour,
 *  ring}; crosses: {row, colour}, at the bottom; limit: above it is what the reference cannot carry; label: of y. */
function plot(g, W, H, spec, look) {
  const left = spec.label ? 48 : 40, right = 10, top = 8, bottom = 30, [x0, x1] = spec.x, [y0, y1] = spec.y;
  const X = row => left + (W - left - right) * (row - x0) / Math.max(1, x1 - x0);
  const Y = v => top + (H - top - bottom) * (y1 - Math.max(y0, Math.min(y1, v))) / (y1 - y0);
  g.globalAlpha = 1;
  g.setLineDash([]);
  if (spec.limit < y1) {
    g.fillStyle = look.soft;
    g.globalAlpha = 0.15;
    g.fillRect(left, top, W - left - right, Math.max(0, Y(spec.limit) - top));
    g.globalAlpha = 1;
    g.textAlign = "right";
    g.fillText("beyond what the reference carries", W - right - 4, top + 14);
  }
  g.strokeStyle = look.rule;
  g.fillStyle = look.soft;
  g.lineWidth = 1;
  g.textAlign = "right";
  for (const t of ticks(y0, y1, H > 250 ? 8 : 5)) {
    g.beginPath();
    g.moveTo(left, Y(t));
    g.lineTo(W - right, Y(t));
    g.stroke();
    g.fillText((spec.label || String)(t), left - 5, Y(t) + 4);
  }
  for (const t of ticks(x0, x1, W > 500 ? 8 : 4).filter(Number.isInteger)) {
    g.textAlign = X(t) > W - 35 ? "right" : "center";
    g.fillText(t, X(t) > W - 35 ? W - right : X(t), H - 14);
  }
  g.textAlign = "right";
  g.fillText("row", W - right, H - 1);
  for (const line of spec.lines) {
    g.strokeStyle = line.colour;
    g.lineWidth = line.width;
    g.setLineDash(line.dash);
    g.beginPath();
    let drawn = false;
    for (let i = 0; i < line.rows.length; ++i) {
      const v = line.values[i];
      if (line.rows[i] < x0) continue;
      if (Number.isFinite(v)) g[drawn ? "lineTo" : "moveTo"](X(line.rows[i]), Y(v));
      drawn = Number.isFinite(v);
    }
    g.stroke();
  }
  g.setLineDash([]);
  g.lineWidth = 2;
  for (const dot of spec.dots) {
    if (dot.row < x0 || dot.row > x1) continue;
    g.fillStyle = g.strokeStyle = dot.colour;
    g.beginPath();
    g.arc(X(dot.row), Y(Number.isFinite(dot.value) ? dot.value : y0), 5, 0, 7);
    dot.ring ? g.stroke() : g.fill();
  }
  for (const { row, colour } of spec.crosses || []) {
    if (row < x0 || row > x1) continue;
    g.strokeStyle = colour;
    g.beginPath();
    g.moveTo(X(row) - 3, Y(y0) - 3);
    g.lineTo(X(row) + 3, Y(y0) + 3);
    g.moveTo(X(row) - 3, Y(y0) + 3);
    g.lineTo(X(row) + 3, Y(y0) - 3);
    g.stroke();
  }
}

/** On a canvas of the page, at the screen's own resolution. */
function draw(canvas, spec, look) {
  const ratio = window.devicePixelRatio || 1, W = canvas.clientWidth, H = canvas.clientHeight;
  const g = canvas.getContext("2d");
  if (canvas.width !== Math.round(W * ratio) || canvas.height !== Math.round(H * ratio)) {
    canvas.width = Math.round(W * ratio);
    canvas.height = Math.round(H * ratio);
  }
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, W, H);
  g.font = "12px system-ui, 'DejaVu Sans', sans-serif";
  plot(g, W, H, spec, look);
}
