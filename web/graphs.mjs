// What is drawn on canvas: the strip of packets, and a small graph for each joint.
import { History, number } from './model.mjs';

const kinds = [['data', '--line'], ['control', '--off'], ['interrupt', '--bad']];
const window_us = 1e6;
const most_graphs = 48;

/** A canvas of as many pixels as it has on the screen, cleared. */
function prepared(canvas) {
  const scale = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
  }
  const context = canvas.getContext('2d');
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** Packets of the last second at the input of one node: time to the right, a row for each source. */
export class Strip {
  constructor(canvas, text) { this.canvas = canvas; this.text = text; this.packets = []; }

  setRing(ring) {
    this.ring = ring;
    this.packets = [];
    this.canvas.style.height = `${Math.min(360, Math.max(90, 4 + 12 * ring.nodes.length))}px`;
    this.rows = new Map(ring.nodes.map((node, i) => [node.id, i]));
  }

  add(message) {
    const last = message.list.at(-1)?.[0];
    if (last != null && this.packets.length && last < this.packets.at(-1)[0]) this.packets = [];
    this.packets.push(...message.list);
    const newest = this.packets.at(-1)?.[0] ?? 0;
    this.packets = this.packets.filter(([time]) => newest - time <= window_us);
    this.tell(message);
    this.draw(newest);
  }

  tell(message) {
    const counts = kinds.map(([word], kind) => this.packets.filter((packet) => packet[3] === kind).length + ' ' + word);
    const damaged = this.packets.filter((packet) => packet[6]).length;
    const at = this.ring.nodes.find((node) => node.id === message.at)?.name ?? message.at;
    const part = message.sample > 1 ? `1 of ${message.sample}, of ` : '';
    const rate = message.rate > 0 ? `, ${part}${number(message.rate)} a second` : ''; // 0: not measured yet
    const text = `Into ${at}${rate}: ${counts.join(', ')} (▲)` + (damaged ? `, ${damaged} of them damaged (✕)` : '');
    if (this.text.textContent !== text) this.text.textContent = text;
  }

  draw(newest) {
    if (!this.ring) return;
    const { context, width, height } = prepared(this.canvas);
    const colours = kinds.map(([, name]) => colour(name)), bad = colour('--bad');
    const names = 92, step = (height - 4) / this.ring.nodes.length, left = width > 500 ? names : 0;
    context.font = '11px system-ui, sans-serif';
    context.fillStyle = colour('--faint');
    const every = Math.ceil(11 / step);
    if (left) this.ring.nodes.forEach((node, i) => i % every === 0 && context.fillText(node.name, 0, 2 + step * (i + 0.5) + 4, names - 6));
    for (const [time, source, , kind, size, damaged] of this.packets) {
      const x = left + (width - left) * (1 - (newest - time) / window_us), y = 2 + step * ((this.rows.get(source) ?? 0) + 0.5);
      context.fillStyle = damaged ? bad : colours[kind];
      const tall = Math.max(2, Math.min(step, 3 + (step - 3) * (size / 524)));
      if (damaged) context.fillText('✕', x - 4, y + 4);
      else if (kind === 2) { context.beginPath(); context.moveTo(x, y - 5); context.lineTo(x + 5, y + 4); context.lineTo(x - 5, y + 4); context.fill(); }
      else context.fillRect(x, y - tall / 2, kind === 1 ? 1 : 2, tall);
    }
  }
}

/** Positions of joints over the last ten seconds. */
export class JointGraphs {
  constructor(parent, title) { this.parent = parent; this.title = title; this.histories = new Map(); }

  setRing(ring) { this.ring = ring; this.histories.clear(); this.show(null); }

  /** Those of one node; null: of all, as many as have room. */
  show(node) {
    const nodes = this.ring.nodes.filter((one) => node == null || one.id === node);
    const joints = nodes.flatMap((one) => one.joints.map((joint, i) => ({ key: `${one.id}/${i}`, joint })));
    this.figures = joints.slice(0, most_graphs).map(({ key, joint }) => this.figure(key, joint));
    this.parent.replaceChildren(...this.figures.map((figure) => figure.element));
    const of = node == null ? '' : ` of ${nodes[0]?.name}`;
    const left = joints.length - this.figures.length;
    this.title.textContent = joints.length ? `Joint positions${of}` + (left > 0 ? ` (${left} more: choose a node)` : '') : `Joint positions${of}: none`;
    this.draw();
  }

  figure(key, joint) {
    const element = document.createElement('figure'), caption = document.createElement('figcaption');
    const name = document.createElement('span'), value = document.createElement('span'), canvas = document.createElement('canvas');
    name.textContent = name.title = joint.name;
    canvas.setAttribute('aria-hidden', 'true'); // its newest value stands beside it
    caption.append(name, value);
    element.append(caption, canvas);
    return { key, joint, element, value, canvas };
  }

  add(message) {
    for (const [node, states] of Object.entries(message.joints))
      for (const [time, ...positions] of states)
        positions.forEach((position, i) => this.history(`${node}/${i}`).add(time / 1e6, position));
    this.draw();
  }

  history(key) {
    if (!this.histories.has(key)) this.histories.set(key, new History(10));
    return this.histories.get(key);
  }

  draw() {
    const line = colour('--line');
    for (const { key, joint, value, canvas } of this.figures) {
      const { points } = this.history(key);
      value.textContent = points.length ? points.at(-1)[1].toFixed(3) + (joint.slides ? ' m' : ' rad') : '-';
      const { context, width, height } = prepared(canvas);
      if (!points.length) continue;
      const [low, high] = this.history(key).range(joint.slides ? 0.01 : 0.1), newest = points.at(-1)[0];
      context.strokeStyle = line;
      context.lineWidth = 1.5;
      context.beginPath();
      for (const [time, position] of points)
        context.lineTo(width * (1 - (newest - time) / 10), height - 2 - (height - 4) * ((position - low) / (high - low)));
      context.stroke();
    }
  }
}
