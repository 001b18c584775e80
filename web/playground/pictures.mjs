// A picture as text of SVG: packets on lines. Times are those of the ring.

const number = (value) => String(+value.toPrecision(5));
const escaped = (text) => String(text).replace(/[&<>"]/g, (one) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' })[one]);
const left = 120, row = 20, axis = 26;

function svg(width, height, label, parts) {
  return `<svg viewBox="0 0 ${width} ${height}" width="${width}" height="${height}" role="img" aria-label="${escaped(label)}">${parts.join('')}</svg>`;
}

/** A scale of so many units below the rows, about six steps of 1, 2 or 5. */
function scale(width, height, most, unit) {
  const rough = most / 6 || 1, power = 10 ** Math.floor(Math.log10(rough)), step = [1, 2, 5, 10].find((one) => one * power >= rough) * power;
  const parts = [];
  for (let at = 0; at <= most * 1.0001; at += step) {
    const x = left + (width * at) / most;
    parts.push(`<path class="grid" d="M${x.toFixed(1)} 0V${height}"/><text class="axis" x="${x.toFixed(1)}" y="${height + 16}">${number(at)}</text>`);
  }
  parts.push(`<text class="axis" x="${left + width}" y="${height + 16}" text-anchor="end">${unit}</text>`);
  return parts;
}

/** Slices and instants of Chrome's trace events on a line each: [{line, begins, lasts, text, kind}] in us. */
export function barsOf(timeline) {
  const names = new Map(), bars = [];
  for (const event of timeline.traceEvents)
    if (event.pid === 1 && event.name === 'thread_name') names.set(event.tid, event.args.name);
  for (const event of timeline.traceEvents) {
    if (event.pid !== 1 || !['X', 'i'].includes(event.ph)) continue;
    bars.push({ line: names.get(event.tid), begins: event.ts, lasts: event.dur ?? 0, text: event.name, kind: event.ph === 'i' ? 'interrupt' : event.args.channel === 'control' ? 'control' : 'data' });
  }
  return { lines: [...names.values()], bars };
}

/** @param shown {lines, bars} of barsOf() @param own source's name, whose bars stand out @param bound us, or null */
export function linesPicture(shown, { from, until, own, bound, width = 900 }) {
  const height = shown.lines.length * row, us = (time) => left + (width * (time - from)) / (until - from);
  const parts = scale(width, height, until - from, 'us');
  shown.lines.forEach((name, i) => parts.push(`<text class="row" x="${left - 6}" y="${i * row + 14}">${escaped(name)}</text>`));
  for (const bar of shown.bars) {
    if (bar.begins + bar.lasts < from || bar.begins > until) continue;
    const y = shown.lines.indexOf(bar.line) * row, x = us(bar.begins), title = `<title>${escaped(bar.text)}: ${number(bar.begins - from)} us, lasts ${number(bar.lasts)} us</title>`;
    if (bar.kind === 'interrupt') parts.push(`<path class="interrupt" d="M${x.toFixed(1)} ${y + 2}l5 14h-10Z">${title}</path>`);
    else parts.push(`<rect class="${bar.text.startsWith(own + ' ') ? 'own' : bar.kind}" x="${x.toFixed(1)}" y="${y + 3}" width="${Math.max(1, us(bar.begins + bar.lasts) - x).toFixed(1)}" height="${row - 6}">${title}</rect>`);
  }
  if (bound != null) parts.push(`<path class="bound" d="M${us(from + bound).toFixed(1)} 0V${height}"/>`);
  return svg(left + width + 20, height + axis, 'Packets on each line', parts);
}
