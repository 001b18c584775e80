// The page of `ringctl view`: what the server tells goes into the picture, the graphs and the lists; what is clicked goes
// back as an order, if the server allows it.
import { JointGraphs, Strip } from './graphs.mjs';
import { bytesText, countersMoved, lineCondition, lineOrder, loadText, nodeCondition, number, timeText } from './model.mjs';
import { RingPicture } from './ring.mjs';
import { connect } from './source.mjs';

const most_events = 200, most_counters = 40, most_of_node = 20;
const by = (id) => document.getElementById(id);
const say = (element, text) => { if (element.textContent !== text) element.textContent = text; };

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) key === 'onclick' ? made.addEventListener('click', value) : made.setAttribute(key, value);
  made.append(...children);
  return made;
}

const page = { control: false, ring: null, status: null, chosen: null, before: null, log: new Map() };
const strip = new Strip(by('strip'), by('strip-text'));
const graphs = new JointGraphs(by('joints'), by('joints-title'));
const picture = new RingPicture(by('picture'), chooseInPicture);

async function order(...words) {
  say(by('said'), `ringctl ${words.join(' ')} ...`);
  const refused = await source.order(words);
  if (refused) say(by('said'), refused);
}

function choose(what) {
  page.chosen = what;
  page.before = null;
  graphs.show(what?.node != null ? page.ring.nodes[what.node].id : null);
  if (page.status) picture.update(page.status, page.chosen);
  return details();
}

/** On a phone the details are far below the picture. */
async function chooseInPicture(what) {
  await choose(what);
  const below = by('details').getBoundingClientRect().top >= by('picture').getBoundingClientRect().bottom;
  if (below) by('details').scrollIntoView({ block: 'nearest' });
}

const button = (text, ...words) => element('button', { 'data-order': words.join(' '), onclick: () => order(...words) }, text);

function facts(pairs) {
  const shown = pairs.filter(([, value]) => value !== '' && value != null);
  return element('dl', {}, ...shown.flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, String(value))]));
}

/** Puts parts into the details. What is as it was stays, so that a button keeps its focus, and a click that has begun. */
function show(title, ...parts) {
  const fresh = [element('h2', {}, title), ...parts.filter((part) => part !== '')], shown = by('details');
  fresh.forEach((part, i) => {
    const was = shown.children[i];
    if (!was) shown.append(part);
    else if (!was.isEqualNode(part)) was.replaceWith(part);
  });
  while (shown.children.length > fresh.length) shown.lastElementChild.remove();
}

async function details() {
  const chosen = page.chosen;
  if (!page.status || !page.ring) return;
  if (chosen?.line != null) return lineDetails(chosen.line);
  if (chosen?.node == null)
    return show('Nothing chosen', element('p', {}, 'Choose a node or a line: by a click, or with arrow keys and Enter.'));
  const node = page.ring.nodes[chosen.node];
  const [row, log] = await Promise.all([source.node(node.id), source.log?.(node.id)]);
  if (page.chosen === chosen) nodeDetails(node, page.status.rows[chosen.node], row, chosen.node, log);
}

function nodeDetails(node, row, full, place, log) {
  const next = page.ring.nodes[(place + 1) % page.ring.nodes.length], cpu = full?.cpu ?? {}, trip = row.round_trip_us ?? {};
  if (!page.before || page.before.pid !== full?.pid) page.before = full;
  const moved = countersMoved(page.before?.counters, full?.counters);
  const controls = page.control ? element('div', { class: 'buttons' },
    button('Hang CPU', 'fault', 'hang', node.name), button('Resume CPU', 'fault', 'resume', node.name),
    button('Reset CPU', 'reset', node.name), button('Stop joints', 'stop', node.name),
    button(`Cut line to ${next.name}`, ...lineOrder('cut', node.name, next.name)), button(`Mend line to ${next.name}`, ...lineOrder('heal', node.name, next.name)),
    button('Kill node', 'fault', 'kill', node.name), button('Start node', 'fault', 'start', node.name)) : '';
  // Buttons first: rows come and go, and would move them away under a click.
  show(`${node.name} (node ${node.id})`, controls, facts([
    ['State', row.state + (row.unanswered ? ': ' + row.unanswered : '')], ['Condition', nodeCondition(row).word],
    ['CPU', [row.cpu, cpu.kind, cpu.boots != null ? `boot ${cpu.boots}` : ''].filter(Boolean).join(', ')],
    ['Last exit', cpu.last_exit], ['Last reset', cpu.last_reset],
    ['Stop', cpu.stop?.latched ? 'latched' : cpu.stop?.pulled ? `pulled ${cpu.stop.pulled} time${cpu.stop.pulled === 1 ? '' : 's'}` : ''],
    ['Faults', (row.faults ?? []).map((fault) => fault.fault).join('; ')],
    ['Line out', full?.output ? [full.output.state, full.output.to != null && `to ${nameOf(full.output.to)}`, loadText(row)].filter(Boolean).join(' ') : ''],
    ['Line in', full?.input ? [full.input.state, full.input.from != null && `from ${nameOf(full.input.from)}`].filter(Boolean).join(' ') : ''],
    ['Packets out', row.packets_per_second != null ? number(row.packets_per_second) + '/s' : ''],
    ['Round trip', trip.p50 != null ? `median ${number(trip.p50)}, 99 % ${number(trip.p99)}, most ${number(trip.max)} us` : ''],
    ['Errors', row.errors], ['Ring of', full?.ring_size], ['Up for', full?.uptime_s != null ? number(full.uptime_s) + ' s' : ''],
    ['Pins', (node.pins ?? []).join(', ')], ['Inputs', (node.inputs ?? []).join(', ')]]),
  element('table', {}, element('caption', {}, 'Counters that moved since it was chosen'),
    element('tr', {}, element('th', { scope: 'col' }, 'Counter'), element('th', { scope: 'col' }, 'By')),
    ...moved.slice(0, most_counters).map(([name, count]) => element('tr', {}, element('td', {}, name), element('td', {}, String(count))))),
  happenedAt(node.id), log == null ? '' : printedBy(node, log));
}

/** What has happened at a node since the page was opened: states, pins, its CPU, its lines. */
function happenedAt(id) {
  const lines = page.log.get(id) ?? [];
  return element('section', {}, element('h3', {}, lines.length ? 'What happened here' : 'Nothing has happened here since the page was opened'),
    element('ul', {}, ...lines.map((line) => element('li', {}, line))));
}

/** What its daemon and its CPU printed, the newest line first, as events are. */
function printedBy(node, log) {
  return element('section', {}, element('h3', {}, 'Log'),
    element('pre', { tabindex: '0', 'aria-label': `Log of ${node.name}, the newest line first` }, log.trimEnd().split('\n').reverse().join('\n')));
}

const nameOf = (id) => page.ring.nodes.find((node) => node.id === id)?.name ?? String(id ?? '-');

function lineDetails(place) {
  const count = page.ring.nodes.length, from = page.ring.nodes[place], to = page.ring.nodes[(place + 1) % count];
  const row = page.status.rows[place], line = lineCondition(row, to, page.status.broken_line);
  const controls = page.control ? element('div', { class: 'buttons' }, button('Cut', ...lineOrder('cut', from.name, to.name)), button('Mend', ...lineOrder('heal', from.name, to.name))) : '';
  show(`Line ${from.name} to ${to.name}`, controls, facts([
    ['State', line.word], ['Load', loadText(row)], ['Packets', row.packets_per_second != null ? number(row.packets_per_second) + '/s' : ''],
    ['Bytes', row.bytes_per_second != null ? bytesText(row.bytes_per_second) + '/s' : ''],
    ['Rate', row.output?.rate_bit_s ? number(row.output.rate_bit_s / 1e6) + ' Mbit/s' : 'as fast as the host']]));
}

const take = {
  view(message) {
    page.control = message.control;
    by('orders').hidden = !page.control;
  },
  ring(message) {
    page.ring = message;
    page.status = null;
    page.log.clear();
    document.title = `${message.ring} - limb_ring`;
    strip.setRing(message);
    graphs.setRing(message);
    picture.setRing(message);
    const { node, line } = page.chosen ?? {};
    choose(Math.max(node ?? 0, line ?? 0) < message.nodes.length ? page.chosen : null); // another ring may be smaller
  },
  status(message) {
    if (!page.ring) return;
    page.status = message;
    say(by('headline'), message.headline.replace(/; virtual clock.*/, ''));
    say(by('report'), message.report);
    by('report').hidden = message.report === '';
    clock(message.clock);
    picture.update(message, page.chosen);
    details();
  },
  happened(message) {
    if (!page.ring) return;
    const node = message.node != null ? nameOf(message.node) + ': ' : '';
    by('events').prepend(element('li', {}, `${timeText(message.time_ns)}  ${node}${message.text}`));
    if (message.node != null) page.log.set(message.node, [`${timeText(message.time_ns)}  ${message.text}`, ...page.log.get(message.node) ?? []].slice(0, most_of_node));
    while (by('events').children.length > most_events) by('events').lastChild.remove();
  },
  flow(message) { picture.flow(message); },
  packets(message) {
    if (!page.ring) return;
    strip.add(message);
    graphs.add(message);
  },
  ordered(message) {
    const ends = ['done', 'it did not happen', 'wrong', 'the ring does not answer', 'nobody knows whether it happened'];
    say(by('said'), `${message.command}: ${ends[message.code] ?? message.code}. ${message.text.trim()}`);
    take.happened({ text: `${message.command}: ${message.text.trim()}` });
  },
  problem(message) { say(by('said'), message.text); },
};

function clock(state) {
  by('clock').hidden = !state || !page.control;
  if (!state) return;
  say(by('headline'), `${by('headline').textContent}; ring's time ${state.now_s.toFixed(state.pace < 0.01 ? 6 : 3)} s${state.paused ? ', paused' : ''}`);
  say(by('pause'), state.paused ? 'Go on' : 'Pause');
  if (document.activeElement !== by('pace')) by('pace').value = String(state.pace);
}

by('pause').addEventListener('click', () => order('clock', page.status.clock.paused ? 'run' : 'pause'));
by('step').addEventListener('click', () => order('clock', 'step', by('step-time').value));
by('pace').addEventListener('change', () => order('clock', 'pace', by('pace').value));
by('stop').addEventListener('click', () => order('stop'));
by('resume').addEventListener('click', () => order('resume'));
by('clear').addEventListener('click', () => order('fault', 'clear'));

const dark = matchMedia('(prefers-color-scheme: dark)');
let theme = localStorage.getItem('theme') ?? 'system';
function paint() {
  document.documentElement.dataset.theme = theme === 'system' ? (dark.matches ? 'dark' : 'light') : theme;
  say(by('theme'), `Theme: ${theme === 'system' ? 'as the system' : theme}`);
}
by('theme').addEventListener('click', () => {
  theme = { system: 'light', light: 'dark', dark: 'system' }[theme];
  localStorage.setItem('theme', theme);
  paint();
});
dark.addEventListener('change', paint);
paint();

const source = connect(take, (text) => say(by('said'), text));
