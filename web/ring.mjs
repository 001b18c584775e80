// The ring as a picture: made once for a ring and a width, changed as rows come.
import { layout, lineCondition, loadText, nodeCondition, shortened } from './model.mjs';

const space = 'http://www.w3.org/2000/svg';

function make(name, attributes = {}, ...children) {
  const element = document.createElementNS(space, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

function set(element, key, value) { if (element.getAttribute(key) !== String(value)) element.setAttribute(key, value); }
function say(element, text) { if (element.textContent !== text) element.textContent = text; }

export class RingPicture {
  /** @param choose called with {node: place} or {line: place} when one is chosen */
  constructor(parent, choose) {
    this.parent = parent;
    this.choose = choose;
    this.current = 0;
    new ResizeObserver(() => this.ring && this.fit()).observe(parent);
  }

  setRing(ring) {
    this.ring = ring;
    this.status = null; // it is of the ring before
    this.current = Math.min(this.current, ring.nodes.length - 1);
    this.width = 0;
    this.fit();
  }

  fit() {
    const width = Math.max(300, this.parent.clientWidth);
    if (width === this.width) return;
    this.width = width;
    this.draw(layout(this.ring.nodes.length, width));
    if (this.status) this.update(this.status, this.chosen);
  }

  draw(place) {
    this.place = place;
    const svg = make('svg', { width: place.width, height: place.height, viewBox: `0 0 ${place.width} ${place.height}`, role: 'group', 'aria-label': `Ring of ${this.ring.nodes.length} nodes` });
    svg.classList.add(place.shape);
    if (place.small) svg.classList.add('small');
    this.second = this.ring.folds_back ? place.second.map((d) => svg.appendChild(make('path', { d, class: 'second' }))) : [];
    this.bypasses = svg.appendChild(make('g'));
    this.lines = this.ring.nodes.map((node, i) => svg.appendChild(this.drawLine(place, i)));
    this.nodes = this.ring.nodes.map((node, i) => svg.appendChild(this.drawNode(place, node, i)));
    this.breaks = this.ring.nodes.map((node, i) => svg.appendChild(this.drawBreak(place.middles[i])));
    this.parent.replaceChildren(svg);
  }

  drawLine(place, i) {
    const middle = place.middles[i];
    // A node's label and details say the same of its line out.
    const group = make('g', { 'aria-hidden': 'true' }, make('path', { class: 'line', d: place.lines[i] }),
      make('path', { class: 'arrow', d: 'M-5 -5 L6 0 L-5 5 Z', transform: `translate(${middle.x} ${middle.y}) rotate(${middle.turn})` }),
      make('path', { class: 'hit', d: place.lines[i] }, make('title')),
      make('text', { class: 'load halo', x: middle.label.x, y: middle.label.y + 4 }));
    group.addEventListener('click', () => this.choose({ line: i }));
    return group;
  }

  drawBreak(middle) {
    return make('g', { class: 'break', 'aria-hidden': 'true', transform: `translate(${middle.x} ${middle.y})` },
      make('path', { d: 'M-8 -8 L8 8 M8 -8 L-8 8' }), make('text', { class: 'halo', x: middle.label.x - middle.x, y: middle.label.y - middle.y + 4 }));
  }

  drawNode(place, node, i) {
    const { x, y } = place.nodes[i], { boxWidth: width, boxHeight: height } = place;
    const group = make('g', { class: 'node off', role: 'button', tabindex: i === this.current ? 0 : -1, transform: `translate(${x} ${y})` },
      make('rect', { class: 'box', x: -width / 2, y: -height / 2, width, height, rx: 7 }),
      make('text', { class: 'name', 'text-anchor': 'middle', y: -3 }, shortened(node.name, place.letters)),
      make('text', { class: 'word', 'text-anchor': 'middle', y: height / 2 - 7 }, 'is asked'), make('text', { class: 'fault halo', x: width / 2 - 3, y: -height / 2 + 6, 'text-anchor': 'middle' }), make('title', {}, node.name));
    group.addEventListener('click', () => { this.focus(i); this.choose({ node: i }); });
    group.addEventListener('keydown', (event) => this.key(event, i));
    return group;
  }

  key(event, i) {
    const steps = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };
    const count = this.nodes.length;
    if (event.key in steps) this.focus((i + steps[event.key] + count) % count);
    else if (event.key === 'Home') this.focus(0);
    else if (event.key === 'End') this.focus(count - 1);
    else if (event.key === 'Enter' || event.key === ' ') this.choose({ node: i });
    else return;
    event.preventDefault();
  }

  focus(i) {
    set(this.nodes[this.current], 'tabindex', -1);
    this.current = i;
    set(this.nodes[i], 'tabindex', 0);
    this.nodes[i].focus();
  }

  update(status, chosen) {
    this.status = status;
    this.chosen = chosen;
    const bypasses = [];
    this.ring.nodes.forEach((node, i) => {
      const row = status.rows[i], next = this.ring.nodes[(i + 1) % this.ring.nodes.length];
      const line = lineCondition(row, next, status.broken_line);
      this.updateNode(node, row, i, chosen?.node === i, line.kind === 'broken' ? `, line to ${next.name} ${line.word}` : '');
      this.updateLine(i, line, row, `${node.name} to ${next.name}`);
      if (line.bypass != null && row.state !== 'down') bypasses.push([i, this.ring.nodes.findIndex((one) => one.id === line.bypass)]);
      if (this.second[i]) this.second[i].classList.toggle('used', this.secondUsed(row, status.rows[(i + 1) % status.rows.length]));
    });
    this.bypasses.replaceChildren(...bypasses.filter(([, to]) => to >= 0).map(([from, to]) => this.bypass(from, to)));
  }

  secondUsed(row, next) { return row?.state === 'folded' && next?.state === 'folded' && !this.isBroken(row, next); }
  isBroken(row, next) { const broken = this.status.broken_line; return broken && broken.before === row.id && broken.behind === next.id; }

  updateNode(node, row, i, selected, line) {
    const group = this.nodes[i], condition = nodeCondition(row);
    set(group, 'class', `node ${condition.kind}${selected ? ' selected' : ''}`);
    set(group, 'aria-label', `${node.name}: ${row?.state ?? 'unknown'}, ${condition.word}${row?.faults?.length ? ', ' + row.faults.map((fault) => fault.fault).join(', ') : ''}${line}`);
    set(group, 'aria-pressed', selected);
    say(group.querySelector('.word'), `${condition.sign} ${condition.word}`);
    say(group.querySelector('.fault'), row?.faults?.length ? '⚡' : '');
  }

  updateLine(i, line, row, name) {
    const group = this.lines[i];
    set(group, 'class', line.kind);
    set(this.breaks[i], 'class', line.kind === 'broken' ? 'break seen' : 'break');
    say(this.breaks[i].querySelector('text'), line.word);
    const load = line.kind === 'up' ? loadText(row) : '';
    say(group.querySelector('.load'), load);
    say(group.querySelector('title'), `${name}: ${line.word}${load ? ', ' + load : ''}`);
    const width = 2 + 8 * Math.min(1, Math.sqrt(row?.load ?? 0));
    group.querySelector('.line').style.strokeWidth = width.toFixed(1);
  }

  /** What is on each line at this moment, in slow motion. @param list by place: {text, kind} or null */
  flow(list) {
    list.forEach((packet, i) => {
      const group = this.lines[i];
      group.classList.toggle('busy', packet?.kind === 'data');
      group.classList.toggle('cut-in', packet?.kind === 'interrupt');
      say(group.querySelector('.load'), packet?.text ?? '');
    });
  }

  bypass(from, to) {
    const a = this.place.nodes[from], b = this.place.nodes[to], middle = { x: this.place.width / 2, y: this.place.height / 2 };
    const pull = (one, by) => one + (by - one) * 0.25;
    const x = pull((a.x + b.x) / 2, middle.x), y = pull((a.y + b.y) / 2, middle.y);
    return make('path', { class: 'bypass', d: `M${a.x} ${a.y} Q${x} ${y} ${b.x} ${b.y}` }, make('title', {}, 'bypass'));
  }
}
