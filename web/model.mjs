// What the page shows, worked out without a page: conditions in words, where nodes stand, which counters moved.

/** How a node is, for its colour, its sign and its words. @param row of `status` */
export function nodeCondition(row) {
  if (!row) return { kind: 'off', sign: '?', word: 'unknown' };
  const { state, cpu } = row;
  if (['down', 'frozen'].includes(state)) return { kind: 'off', sign: '○', word: state };
  if (state === 'unanswered') return { kind: 'bad', sign: '?', word: 'no answer' };
  if (state === 'duplicate_id') return { kind: 'bad', sign: '✕', word: 'duplicate id' };
  if (['starting', 'joining', 'alone'].includes(state)) return { kind: 'warn', sign: '…', word: state };
  if (['hung', 'failed'].includes(cpu)) return { kind: 'bad', sign: '✕', word: 'CPU ' + cpu };
  if (cpu === 'stopped') return { kind: 'warn', sign: '■', word: 'stopped' };
  if (['silent', 'booting'].includes(cpu)) return { kind: 'warn', sign: '!', word: 'CPU ' + cpu };
  if (['absent', 'none', 'unknown'].includes(cpu)) return { kind: 'good', sign: '✓', word: cpu === 'unknown' ? state : 'no CPU' };
  return { kind: 'good', sign: '✓', word: 'running' };
}

/** How the line from a node to the next in the ring's order is. @param broken {before, behind} or null */
export function lineCondition(row, next, broken) {
  const faults = (row?.faults ?? []).filter((fault) => /^\S+ .*->/.test(fault.fault ?? ''));
  const cut = faults.some((fault) => /^(cut|flap) /.test(fault.fault));
  if (cut || (broken && broken.before === row?.id && broken.behind === next?.id))
    return { kind: 'broken', word: cut ? 'cut' : 'broken' };
  const elsewhere = row?.to != null && row.to !== next?.id;
  if (!row || row.to == null || elsewhere) return { kind: 'down', word: elsewhere ? 'bypassed' : 'down', bypass: elsewhere ? row.to : null };
  return { kind: 'up', word: faults.length ? faults.map((fault) => fault.fault).join(', ') : 'up' };
}

/** "12 %", "0.02 %", or bytes a second where the line has no rate. */
export function loadText(row) {
  if (row?.load != null) return number(row.load * 100) + ' %';
  return row?.bytes_per_second != null ? bytesText(row.bytes_per_second) + '/s' : '';
}

export function bytesText(bytes) {
  const units = ['B', 'kB', 'MB', 'GB'];
  let unit = 0;
  while (bytes >= 1000 && unit < units.length - 1) { bytes /= 1000; ++unit; }
  return number(bytes) + ' ' + units[unit];
}

/** With two digits that say something, at least. */
export function number(value) {
  if (value == null) return '-';
  if (value === 0 || Math.abs(value) >= 100) return value.toFixed(0);
  if (Math.abs(value) >= 10) return value.toFixed(1);
  return value.toFixed(Math.abs(value) >= 0.1 ? 2 : 3);
}

/** The time of an event: of the day, or of a virtual ring's clock, which begins at 0. */
export function timeText(ns) {
  if (ns == null) return '';
  if (ns < 1e17) return (ns / 1e9).toFixed(6) + ' s';
  const at = new Date(ns / 1e6), two = (n) => String(n).padStart(2, '0');
  return `${two(at.getHours())}:${two(at.getMinutes())}:${two(at.getSeconds())}.${String(at.getMilliseconds()).padStart(3, '0')}`;
}

/** Counters that are not as they were: [name, by how much], the largest first. @param before of the same boot */
export function countersMoved(before, now) {
  return Object.entries(now ?? {})
    .map(([name, value]) => [name, value - (before?.[name] ?? 0)])
    .filter(([, moved]) => moved !== 0)
    .sort((a, b) => b[1] - a[1] || a[0].localeCompare(b[0]));
}

/** As much of a name as fits, its end left out. */
export function shortened(text, most) { return text.length <= most ? text : text.slice(0, most - 1) + '…'; }

const oval = { box: [104, 42], most: 20, least: 620, gap: 4 };

/**
 * Where the nodes of a ring stand in a picture so many pixels wide, and the ways of the lines between them: an oval if
 * there is room, else rows that are read to and fro, as one ploughs. Line i leads from node i to the next.
 */
export function layout(count, width) {
  if (count > oval.most || width < oval.least) return rowsLayout(count, width);
  const place = ovalLayout(count, Math.min(width, 1100));
  return hasRoom(place) ? place : rowsLayout(count, width);
}

function hasRoom({ nodes, boxWidth, boxHeight }) {
  return nodes.every((a, i) => nodes.every((b, k) => i === k || Math.abs(a.x - b.x) >= boxWidth + oval.gap || Math.abs(a.y - b.y) >= boxHeight + oval.gap));
}

function ovalLayout(count, width) {
  const [boxWidth, boxHeight] = oval.box, height = Math.round(Math.min(width * 0.6, 560));
  const rx = (width - boxWidth) / 2 - 24, ry = (height - boxHeight) / 2 - 24;
  const at = (place, share = 1) => {
    const angle = (2 * Math.PI * place) / count - Math.PI / 2;
    return { x: width / 2 + rx * share * Math.cos(angle), y: height / 2 + ry * share * Math.sin(angle) };
  };
  const nodes = [...Array(count).keys()].map((place) => at(place));
  const arc = (share) => nodes.map((_, i) => {
    const a = at(i, share), b = at(i + 1, share);
    return `M${a.x.toFixed(1)} ${a.y.toFixed(1)} A${(rx * share).toFixed(1)} ${(ry * share).toFixed(1)} 0 0 1 ${b.x.toFixed(1)} ${b.y.toFixed(1)}`;
  });
  const middles = nodes.map((_, i) => {
    const a = at(i + 0.48), b = at(i + 0.52);
    return { ...at(i + 0.5), turn: (Math.atan2(b.y - a.y, b.x - a.x) * 180) / Math.PI, label: at(i + 0.5, 0.8) };
  });
  return { shape: 'oval', width, height, boxWidth, boxHeight, letters: 14, nodes, lines: arc(1), second: arc(0.92), middles };
}

function rowsLayout(count, width) {
  const small = count > 64;
  const [boxWidth, boxHeight] = small ? [84, 32] : [108, 42], [gapX, gapY] = small ? [12, 10] : [26, 26], margin = 26;
  const columns = Math.max(1, Math.min(count, Math.floor((width - 2 * margin + gapX) / (boxWidth + gapX))));
  const rows = Math.ceil(count / columns);
  const nodes = [...Array(count).keys()].map((i) => {
    const row = Math.floor(i / columns), along = i % columns, column = row % 2 ? columns - 1 - along : along;
    return { x: margin + boxWidth / 2 + column * (boxWidth + gapX), y: margin / 2 + boxHeight / 2 + row * (boxHeight + gapY) };
  });
  const bottom = margin / 2 + rows * (boxHeight + gapY) + 2, left = margin / 3;
  const home = (d) => `M${nodes[count - 1].x} ${nodes[count - 1].y} V${bottom - d} H${left + d} V${nodes[0].y} H${nodes[0].x}`;
  const way = (d) => nodes.map((a, i) => i === count - 1 ? home(d) : `M${a.x + d} ${a.y + d} L${nodes[i + 1].x + d} ${nodes[i + 1].y + d}`);
  const middles = nodes.map((a, i) => {
    const b = nodes[(i + 1) % count], last = i === count - 1;
    const x = last ? left : (a.x + b.x) / 2, y = last ? (bottom + nodes[0].y) / 2 : (a.y + b.y) / 2;
    const turn = last ? -90 : (Math.atan2(b.y - a.y, b.x - a.x) * 180) / Math.PI;
    return { x, y, turn, label: { x, y: y - 16 } };
  });
  const full = margin * 2 + columns * (boxWidth + gapX) - gapX;
  return { shape: 'rows', small, width: full, height: bottom + 8, boxWidth, boxHeight, letters: small ? 13 : 14, nodes, lines: way(0), second: way(5), middles };
}

/** The order that begins or ends a fault of a line. */
export const lineOrder = (word, from, to) => ['fault', word, `${from}:${to}`];

/** Values of the last so many seconds; the newest time comes last. */
export class History {
  constructor(seconds) { this.seconds = seconds; this.points = []; }
  add(time, value) {
    const last = this.points.at(-1);
    if (last && time < last[0]) this.points = []; // another life of the ring's clock
    this.points.push([time, value]);
    while (this.points.length && time - this.points[0][0] > this.seconds) this.points.shift();
  }
  /** [least, most] of the values, at least so far apart. */
  range(least) {
    let low = Infinity, high = -Infinity;
    for (const [, value] of this.points) { low = Math.min(low, value); high = Math.max(high, value); }
    const lacking = Math.max(0, least - (high - low)) / 2;
    return [low - lacking, high + lacking];
  }
}
