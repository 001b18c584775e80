// The simulator as WebAssembly beside the programs: PAGE is the playground's folder, PROGRAMS that of ring_sim and ringctl.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import test from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';

const { PAGE, PROGRAMS } = process.env;
const root = fileURLToPath(new URL('../..', import.meta.url));
const { readAddress, simulator } = await import(pathToFileURL(join(PAGE, 'tab.mjs')));
const ask = await simulator({ wasmBinary: readFileSync(join(PAGE, 'limb_ring.wasm')) });
const examples = JSON.parse(readFileSync(join(PAGE, 'examples.json'), 'utf8'));
for (const [path, text] of Object.entries(examples)) assert.deepEqual(ask({ do: 'file', path, text }), {});
const program = (name, ...words) => execFileSync(join(PROGRAMS, name), words, { cwd: root, encoding: 'utf8', maxBuffer: 2 ** 28 });

for (const [which, nodes, payload, seed] of [['alone', 16, 512, 1], ['simultaneous', 5, 64, 1], ['adversarial', 16, 512, 1], ['request', 16, 100, 1],
  ['delivery', 254, 1, 1], ['interrupt', 16, 512, 1], ['interrupt_bound', 3, 512, 7], ['random', 4, 33, 9], ['saturated', 3, 512, 1]]) {
  test(`${which} of ${nodes} nodes and ${payload} bytes has the trace of ring_sim, byte for byte`, () => {
    const words = ['run', '--case', which, '--nodes', String(nodes), '--payload', String(payload), '--seed', String(seed)];
    const expected = JSON.parse(program('ring_sim', ...words, '--json'));
    const here = ask({ do: 'case', case: which, nodes, payload, seed, trace: true, timeline: false });
    for (const name of ['trace_hash', 'formula_us', 'measured_us', 'packets', 'formula']) assert.equal(here[name], expected[name], name);
    if (nodes <= 16 && which !== 'interrupt_bound') assert.ok(here.trace === execFileSync(join(PROGRAMS, 'ring_sim'), [...words, '--trace', '-'], { encoding: 'utf8', maxBuffer: 2 ** 28, stdio: ['ignore', 'pipe', 'ignore'] }), 'the traces differ');
  });
}

test("the worst case of the paper takes 75.264 us, and its timeline shows our packet on every line", () => {
  const { measured_us, timeline } = ask({ do: 'case', case: 'adversarial' });
  assert.equal(measured_us, 75.264);
  const ours = timeline.traceEvents.filter((event) => event.ph === 'X' && event.name.startsWith('node0 -> ') && event.args.channel === 'user');
  assert.equal(new Set(ours.map((event) => event.tid)).size, 16);
});

test('every scenario is judged as ringctl judges it, with the same report', () => {
  const paths = Object.keys(examples).filter((path) => /^\/test\/scenarios\/\d/.test(path));
  assert.ok(paths.length >= 40);
  const reports = paths.map((path) => {
    const { report, error } = ask({ do: 'scenario', path, text: examples[path] });
    return error ?? report.replace(path, path.slice(1));
  });
  assert.equal(`${reports.join('\n')}\n${paths.length} scenarios: all as expected\n`, program('ringctl', 'scenario', 'run', ...paths.map((path) => path.slice(1))));
});

test('what is wrong in a file is said with its line and what would be right', () => {
  assert.match(ask({ do: 'open', ring: 'ring: x\nnodez: []' }).error, /ring\.yaml:2:1: entry 'nodez': is unknown, did you mean 'nodes'\?/);
  assert.match(ask({ do: 'scenario', path: '/x.yaml', text: '{' }).error, /x\.yaml:1/);
  assert.match(ask({ do: 'case', case: 'never' }).error, /no such case/);
});

const run = (ms) => ask({ do: 'run', for_us: ms * 1000, most: 1e9 });
const row = (name) => ask({ do: 'status' }).rows.find((one) => one.name === name);

test('a CPU hangs, an interrupt resets it, and it comes back with one more boot', () => {
  ask({ do: 'open', ring: examples['/config/humanoid16.yaml'] });
  run(100);
  assert.equal(ask({ do: 'order', words: ['fault', 'hang', 'left_knee'] }).code, 0);
  run(1000);
  assert.equal(row('left_knee').cpu, 'hung');
  const said = ask({ do: 'order', words: ['reset', 'left_knee'] });
  assert.match(said.text, /INT0 sent by body/);
  const { packets, happened } = run(1000);
  assert.equal(packets.filter((packet) => packet[4] === 2).length, 16, 'the INTP is on each line once');
  assert.ok(happened.some((event) => event.text === 'CPU running, boot 2'));
  assert.equal(row('left_knee').cpu, 'running');
  assert.deepEqual(row('left_knee').faults, []);
});

test('a wire that is cut is located, and the ring closes when it is mended', () => {
  ask({ do: 'open', nodes: 6 });
  run(300);
  ask({ do: 'order', words: ['fault', 'cut', 'node2:node3'] });
  run(1000);
  assert.deepEqual(ask({ do: 'status' }).broken_line, { before: 2, behind: 3 });
  ask({ do: 'order', words: ['fault', 'clear'] });
  run(1000);
  const status = ask({ do: 'status' });
  assert.equal(status.broken_line, null);
  assert.ok(status.rows.every((one) => one.state === 'up' && one.faults.length === 0));
  assert.equal(status.report, '');
});

test('an order that makes no sense changes nothing and says why', () => {
  for (const words of [['reset', 'nobody'], ['fault', 'explode', 'node1'], ['fault', 'cut', 'node1:node5'], ['down'], []])
    assert.equal(ask({ do: 'order', words }).code, 2, words.join(' '));
});

test('the addresses in the manual show what they say: all words are known, and what they do to the ring can be done', () => {
  const docs = join(root, 'docs'), pages = readdirSync(docs, { withFileTypes: true }).filter((one) => one.isDirectory())
    .flatMap((folder) => readdirSync(join(docs, folder.name)).filter((file) => file.endsWith('.md')).map((file) => join(docs, folder.name, file)));
  const addresses = pages.flatMap((page) => [...readFileSync(page, 'utf8').matchAll(/<!-- playground (#\S*): /g)].map((match) => match[1]));
  assert.ok(addresses.length >= 4);
  for (const address of addresses) {
    const shown = readAddress(address);
    assert.equal(Object.keys(shown).length, [...new URLSearchParams(address.slice(1))].length, address);
    ask({ do: 'open', ring: examples[`/config/${shown.ring ?? 'humanoid16'}.yaml`] });
    for (const [at, ...words] of shown.orders ?? []) {
      ask({ do: 'run', for_us: at, most: 1e9 });
      assert.equal(ask({ do: 'order', words }).code, 0, address);
    }
  }
});

test('the load that is asked for is the load on the lines', () => {
  for (const [nodes, size, load] of [[16, 512, 20], [4, 512, 50]]) {
    ask({ do: 'open', nodes, size, every_us: (nodes * (size + 12) * 0.008) / (load / 100) });
    run(20);
    ask({ do: 'status' });
    run(20);
    const seen = row('node0').load;
    assert.ok(Math.abs(seen - load / 100) < 0.01, `${seen} of ${load} %`);
  }
});
