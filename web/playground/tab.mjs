// What the playground is made of, without a page: the simulator, what its address says, and its strip of lines.

/** A function that takes a request of playground.cpp and gives its answer. @param options for emscripten */
export async function simulator(options = {}) {
  const { default: make } = await import('./limb_ring.mjs');
  const module = await make(options);
  return (request) => {
    const text = JSON.stringify(request), size = module.lengthBytesUTF8(text) + 1, at = module._malloc(size);
    module.stringToUTF8(text, at, size);
    try { return JSON.parse(module.UTF8ToString(module._ask(at))); } finally { module._free(at); }
  };
}

/** What is shown if the address says nothing. */
export const usual = {
  ring: 'humanoid16', yaml: null, nodes: 16, size: 512, rate: 1e9, load: 20, seed: 1, pace: 1e-5, at: 0, paused: false, orders: [],
  case: 'adversarial', scenario: '/test/scenarios/01-broken-wire-in-the-left-leg.yaml', scenario_yaml: null, show: '',
};

/** The part of an address behind '#', for what is not usual. */
export function writeAddress(shown) {
  const words = new URLSearchParams();
  for (const [name, value] of Object.entries(shown))
    if (JSON.stringify(value) !== JSON.stringify(usual[name])) words.set(name, typeof value === 'string' ? value : JSON.stringify(value));
  return words.toString();
}

/** The reverse. What is unknown or of a wrong type is left out: anybody can write an address. */
export function readAddress(hash) {
  const shown = {};
  for (const [name, text] of new URLSearchParams(hash.replace(/^#/, ''))) {
    if (!(name in usual)) continue;
    const is_text = typeof usual[name] === 'string' || usual[name] === null;
    let value = text;
    if (!is_text) try { value = JSON.parse(text); } catch { continue; }
    if (is_text || (typeof value === typeof usual[name] && isSane(name, value))) shown[name] = value;
  }
  return shown;
}

const limits = { nodes: [2, 254], size: [1, 512], rate: [1e6, 1e11], load: [0, 95], seed: [0, 2 ** 53 - 1], pace: [1e-6, 1], at: [0, 1e12] };

function isSane(name, value) {
  if (name in limits) return value >= limits[name][0] && value <= limits[name][1];
  if (name !== 'orders') return true;
  return Array.isArray(value) && value.length <= 1000 && value.every((order) => Array.isArray(order) && Number.isFinite(order[0]) && order.slice(1).every((word) => typeof word === 'string'));
}

/** How often each CPU sends to all, in us, so that the lines are that busy; 0: never. Each packet passes every line. */
export function periodFor(nodes, { size, rate, load }) {
  return load > 0 ? (nodes * (size + 12) * 8e6) / rate / (load / 100) : 0;
}

/** Packets on the lines out of all nodes, over time: a row for each line. */
export class LineStrip {
  constructor(canvas, text) { this.canvas = canvas; this.text = text; this.packets = []; this.open = []; }

  setRing(ring) {
    this.packets = [];
    this.open = [];
    this.canvas.style.height = `${Math.min(420, Math.max(90, 4 + 16 * ring.nodes.length))}px`;
  }

  /** @param packets [[begins us, ends us or null, line, source, kind, bytes] ...] */
  add(packets, now) {
    this.packets.push(...packets.filter((packet) => packet[1] != null));
    this.open = packets.filter((packet) => packet[1] == null);
    if (this.packets.length > 20000) this.packets.splice(0, this.packets.length - 20000);
    this.now = now;
  }

  /** What is on each line now. @param glow us: so long an interrupt is seen */
  flow(now, glow, names) {
    const lines = names.map(() => null);
    const name = (packet) => names[packet[3]] ?? packet[3];
    for (const packet of this.open) lines[packet[2]] = { kind: 'data', text: name(packet) };
    for (let i = this.packets.length - 1; i >= 0 && now - this.packets[i][0] < glow + 100; --i) {
      const packet = this.packets[i], [begins, ends, line, , kind] = packet;
      if (kind === 2 && now - begins < glow) lines[line] = { kind: 'interrupt', text: `▲ ${name(packet)}` };
      else if (begins <= now && now < ends && !lines[line]) lines[line] = { kind: 'data', text: name(packet) };
    }
    return lines;
  }

  draw(now, window_us, names) {
    const scale = globalThis.devicePixelRatio || 1, width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (this.canvas.width !== Math.round(width * scale)) this.canvas.width = Math.round(width * scale);
    if (this.canvas.height !== Math.round(height * scale)) this.canvas.height = Math.round(height * scale);
    const context = this.canvas.getContext('2d'), style = getComputedStyle(document.documentElement);
    const colour = (one) => style.getPropertyValue(one).trim();
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, width, height);
    const left = width > 500 ? 104 : 0, step = (height - 4) / names.length, x = (time) => left + (width - left) * (1 - (now - time) / window_us);
    context.font = '11px system-ui, sans-serif';
    context.fillStyle = colour('--text');
    if (left && step >= 10) names.forEach((name, i) => context.fillText(name, 0, 2 + step * (i + 0.5) + 4, left - 8));
    const colours = [colour('--line'), colour('--off'), colour('--bad')], back = colour('--back');
    let seen = 0;
    // Interrupts last: they lie inside the packets that they cut into.
    const recent = [...this.packets.filter((packet) => packet[1] > now - window_us), ...this.open].sort((a, b) => a[4] - b[4]);
    for (const [begins, ends, line, source, kind] of recent) {
      const from = Math.max(left, x(begins)), to = Math.min(width, x(ends ?? now)) - (ends != null && kind < 2 ? 1.5 : 0), y = 2 + step * line;
      context.fillStyle = colours[kind];
      context.fillRect(from, y + 1, Math.max(kind === 2 ? 3 : 1, to - from), step - 2);
      if (kind < 2 && to - from > 60 && step > 11) {
        context.fillStyle = back;
        context.fillText(names[source] ?? source, from + 4, y + step / 2 + 4, to - from - 8);
      }
      ++seen;
    }
    const span = window_us >= 1e6 ? `${window_us / 1e6} s` : window_us >= 1e3 ? `${window_us / 1e3} ms` : `${window_us.toFixed(0)} us`;
    const text = `The last ${span} of the ring's time, on the line out of each node; the words in a bar are its source. Interrupts are narrow and orange, inside the packet that they cut into.`;
    if (this.text.textContent !== text) this.text.textContent = text;
    return seen;
  }
}
