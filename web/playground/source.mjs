// The page's ring, inside the page: the simulator as WebAssembly. Time goes on while the page is drawn, at the pace that is
// chosen; what is shown stands in the address, so that it can be sent to somebody.
import { number } from './model.mjs';
import { barsOf, linesPicture } from './pictures.mjs';
import { LineStrip, periodFor, readAddress, simulator, usual, writeAddress } from './tab.mjs';

const by = (id) => document.getElementById(id);
const slow = 1e-3;           // below this pace single packets are seen
const status_ms = 400;
const replay_ms = 3000;      // of computing: how far a page goes to where its address says that it was
const at_once = 6000;        // slices in one frame, so that the page stays fluid

const shown = { ...usual, ...readAddress(location.hash) };
let ask, take, say, strip, names = [], now_us = 0, paused = shown.paused, last = 0, told = 0, examples;

export function connect(to, tell) {
  take = to;
  say = tell;
  begin().catch((problem) => say(`The simulator did not start: ${problem.message}`));
  return { order, node: async (id) => ask({ do: 'node', id }) };
}

async function begin() {
  const [made, files] = await Promise.all([simulator(), fetch('examples.json').then((answer) => answer.json())]);
  ask = made;
  examples = files;
  for (const [path, text] of Object.entries(examples)) ask({ do: 'file', path, text });
  document.title = 'limb_ring playground';
  controls();
  strip = new LineStrip(by('strip'), by('strip-text'));
  take.view({ control: true });
  open(shown.orders);
  if (shown.show === 'case') runCase();
  if (shown.show === 'scenario') runScenario();
  if (shown.show) window.scrollTo(0, by(`${shown.show}s`).offsetTop);
  requestAnimationFrame(frame);
}

/** The ring from its start, and what was done to it. @param orders [[us, words] ...] */
function open(orders = []) {
  shown.orders = [];
  const text = shown.yaml ?? examples[`/config/${shown.ring}.yaml`] ?? '';
  const request = { do: 'open', ring: text, nodes: shown.nodes, rate: shown.rate, delay_ns: 512, seed: shown.seed, size: shown.size };
  const first = ask(request);
  by('ring-error').textContent = first.error ?? '';
  if (first.error) return;
  request.every_us = periodFor(first.nodes.length, shown);
  const ring = ask(request);
  if (ring.error) { by('ring-error').textContent = ring.error; return; }
  names = ring.nodes.map((one) => one.name);
  by('events').replaceChildren();
  take.ring(ring);
  strip.setRing(ring);
  now_us = 0;
  advance(0);
  start_us = now_us;
  replay(orders);
  tellStatus();
}

let start_us = 0;

function replay(orders) {
  const enough = performance.now() + replay_ms;
  const goTo = (us) => { while (now_us < us - 1e-6 && performance.now() < enough) advance(us - now_us); };
  for (const [at, ...words] of orders) {
    goTo(at);
    give(words);
  }
  goTo(shown.at);
  if (now_us < shown.at - 1) say(`Replayed up to ${number(now_us / 1000)} ms only: the address says ${number(shown.at / 1000)} ms.`);
}

function advance(us) {
  const answer = ask({ do: 'run', for_us: us, most: at_once });
  now_us = answer.now_us;
  for (const event of answer.happened) take.happened(event);
  strip.add(answer.packets, now_us);
}

function frame(time) {
  const passed = Math.min(100, time - last);
  last = time;
  if (!paused && names.length) advance(passed * 1000 * shown.pace);
  if (names.length) draw();
  if (time - told > status_ms) { told = time; tellStatus(); }
  requestAnimationFrame(frame);
}

function draw() {
  strip.draw(now_us, 3e6 * shown.pace, names);
  if (shown.pace < slow) take.flow(strip.flow(now_us, 0.2e6 * shown.pace, names));
}

function tellStatus() {
  if (!names.length) return;
  take.status({ ...ask({ do: 'status' }), clock: { now_s: now_us / 1e6, paused, pace: shown.pace } });
  if (paused) remember();
}

function remember() {
  shown.at = now_us;
  shown.paused = paused;
  history.replaceState(null, '', '#' + writeAddress(shown));
}

/** What is done to the ring, with its time, so that the address tells it. */
function give(words) {
  const answer = ask({ do: 'order', words });
  if (answer.code === 0) shown.orders.push([now_us, ...words]);
  take.ordered(answer);
}

const clock = {
  pause() { paused = true; },
  run() { paused = false; },
  step(by_text) { paused = true; const [, count, unit] = /^([\d.]+)(us|ms|s)$/.exec(by_text); advance(Number(count) * { us: 1, ms: 1e3, s: 1e6 }[unit]); },
  pace(pace) { shown.pace = Number(pace); },
};

async function order(words) {
  if (words[0] === 'clock') clock[words[1]](words[2]);
  else if (words[0] === 'stop' && words.length === 1) names.forEach((name) => give(['stop', name]));
  else give(words);
  if (words[0] === 'clock') say('');
  tellStatus();
  remember();
}

// ---- what the page has beside the ring -------------------------------------------------------

function controls() {
  by('resume').hidden = true; // the models of CPUs have no joints to resume
  by('positions').hidden = true;
  document.querySelector('#packets h2').textContent = 'Packets on each line';
  by('pace').replaceChildren(...[[1e-6, '1 us'], [1e-5, '10 us'], [1e-4, '100 us'], [1e-3, '1 ms'], [1e-2, '10 ms'], [1e-1, '100 ms'], [1, '1 s']]
    .map(([value, text]) => new Option(`${text} in a second`, value)));
  by('playground').hidden = false;
  const paths = Object.keys(examples), rings = paths.filter((path) => path.startsWith('/config/')).map((path) => path.slice(8, -5));
  by('ring').replaceChildren(new Option('plain nodes', ''), ...rings.map((name) => new Option(name)));
  by('scenario').replaceChildren(...paths.filter((path) => /^\/test\/scenarios\/\d/.test(path)).map((path) => new Option(path.slice(16, -5), path)));
  fill();
  for (const id of ['nodes', 'size', 'rate', 'load', 'ring']) by(id).addEventListener('input', () => change(id));
  by('yaml').addEventListener('change', () => { shown.yaml = by('yaml').value; reopen(); });
  by('again').addEventListener('click', reopen);
  by('run-case').addEventListener('click', () => { shown.case = by('case').value; runCase(); remember(); });
  by('scenario').addEventListener('change', () => { shown.scenario = by('scenario').value; shown.scenario_yaml = null; fillScenario(); });
  by('run-scenario').addEventListener('click', () => { noteScenario(); runScenario(); remember(); });
}

function fill() {
  for (const id of ['nodes', 'size', 'rate', 'load', 'ring']) by(id).value = shown[id];
  by('yaml').value = shown.yaml ?? examples[`/config/${shown.ring}.yaml`] ?? '';
  by('case').value = shown.case;
  by('scenario').value = shown.scenario;
  fillScenario();
  tellSliders();
}

function fillScenario() { by('scenario-yaml').value = shown.scenario_yaml ?? examples[shown.scenario] ?? ''; }

function noteScenario() {
  shown.scenario_yaml = by('scenario-yaml').value === examples[shown.scenario] ? null : by('scenario-yaml').value;
}

function tellSliders() {
  by('nodes-value').textContent = by('ring').value === '' && !shown.yaml ? shown.nodes : 'of the file';
  by('nodes').disabled = by('ring').value !== '' || Boolean(shown.yaml);
  by('size-value').textContent = `${shown.size} bytes`;
  by('load-value').textContent = `${shown.load} %`;
}

function change(id) {
  shown[id] = id === 'ring' ? by(id).value : Number(by(id).value);
  if (id === 'ring') { shown.yaml = null; by('yaml').value = examples[`/config/${shown.ring}.yaml`] ?? ''; }
  tellSliders();
  reopen();
}

function reopen() {
  shown.at = 0;
  open();
  remember();
}

function runCase() {
  shown.show = 'case';
  const answer = ask({ do: 'case', case: shown.case, nodes: shown.nodes, payload: shown.size, rate: shown.rate, seed: shown.seed });
  if (answer.error) { by('case-text').textContent = answer.error; return; }
  const of = barsOf(answer.timeline), from = caseBegin(of.bars, answer.measured_us);
  by('case-text').textContent = `${answer.formula} = ${answer.formula_us.toFixed(3)} us; measured ${answer.measured_us.toFixed(3)} us. Trace hash ${answer.trace_hash}, ` +
    `as 'ring_sim run --case ${shown.case} --nodes ${shown.nodes} --payload ${shown.size} --rate ${shown.rate / 1e6}Mbit/s' prints it. The dashed line is the formula; each bar is a packet on a line, our own stands out.`;
  by('case-picture').innerHTML = linesPicture(of, { from, until: from + answer.formula_us * 1.05, own: 'node0', bound: answer.formula_us });
}

/**
 * When a case begins, in us of its timeline: so long before the tail of our packet is back. A bar ends where that begins
 * to come in: it has what is left of the last word, trailer and CRC; an interrupt has only an instant.
 */
function caseBegin(bars, measured_us) {
  const ours = bars.filter((bar) => bar.text.includes('node0 -> ') && bar.kind !== 'control');
  const end = Math.max(...ours.map((bar) => bar.begins + bar.lasts + ((bar.kind === 'interrupt' ? 12 : 8 + (shown.size % 4)) * 8e6) / shown.rate));
  return end - measured_us;
}

function runScenario() {
  shown.show = 'scenario';
  if (by('yaml').value) ask({ do: 'file', path: '/test/scenarios/ring.yaml', text: by('yaml').value }); // its `ring: ring.yaml`
  const answer = ask({ do: 'scenario', path: shown.scenario, text: by('scenario-yaml').value, seed: undefined });
  by('scenario-report').textContent = answer.error ?? answer.report;
  by('scenario-verdict').textContent = answer.error ? '✕ not run' : answer.as_expected ? '✓ as expected' : '✕ not as expected';
  by('scenario-verdict').className = answer.as_expected ? 'good' : 'bad';
  by('scenario-picture').innerHTML = answer.picture ?? '';
}
