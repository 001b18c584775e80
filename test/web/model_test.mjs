import assert from 'node:assert/strict';
import test from 'node:test';
import { bytesText, countersMoved, History, layout, lineCondition, lineOrder, loadText, nodeCondition, number, shortened, timeText } from '../../web/model.mjs';
import { barsOf, linesPicture } from '../../web/playground/pictures.mjs';
import { periodFor, readAddress, usual, writeAddress } from '../../web/playground/tab.mjs';

const up = (row = {}) => ({ id: 1, state: 'up', cpu: 'running', to: 2, faults: [], load: 0.1, ...row });

test('a node is as its state says, and if that is well, as its CPU is', () => {
  assert.equal(nodeCondition(up()).kind, 'good');
  assert.deepEqual(nodeCondition(up({ cpu: 'hung' })), { kind: 'bad', sign: '✕', word: 'CPU hung' });
  assert.equal(nodeCondition(up({ state: 'down', cpu: 'hung' })).word, 'down');
  assert.equal(nodeCondition(up({ state: 'joining' })).kind, 'warn');
  assert.deepEqual(nodeCondition(up({ cpu: 'stopped' })), { kind: 'warn', sign: '■', word: 'stopped' });
  assert.equal(nodeCondition(up({ cpu: 'none' })).word, 'no CPU');
  assert.equal(nodeCondition(undefined).word, 'unknown');
});

test('every condition has a sign of its own kind, so that colour is never all there is', () => {
  const signs = [up(), up({ cpu: 'hung' }), up({ state: 'down' }), up({ cpu: 'silent' })].map((row) => nodeCondition(row).sign);
  assert.equal(new Set(signs).size, signs.length);
});

test('a line is broken where the ring has found the break, or where it was cut on purpose', () => {
  const next = { id: 2 };
  assert.equal(lineCondition(up(), next, null).kind, 'up');
  assert.equal(lineCondition(up({ to: null }), next, { before: 1, behind: 2 }).word, 'broken');
  assert.equal(lineCondition(up({ faults: [{ fault: 'cut a -> b' }] }), next, null).word, 'cut');
  assert.equal(lineCondition(up(), next, { before: 4, behind: 5 }).kind, 'up');
});

test('a fault of a CPU does not make its line a broken one', () => {
  assert.deepEqual(lineCondition(up({ faults: [{ fault: 'hang a' }] }), { id: 2 }, null), { kind: 'up', word: 'up' });
  assert.equal(lineCondition(up({ faults: [{ fault: 'delay a -> b delay=5ms' }] }), { id: 2 }, null).word, 'delay a -> b delay=5ms');
});

test('a line that leads past the next node is a bypass', () => {
  assert.deepEqual(lineCondition(up({ to: 3 }), { id: 2 }, null), { kind: 'down', word: 'bypassed', bypass: 3 });
  assert.equal(lineCondition(up({ to: null }), { id: 2 }, null).word, 'down');
});

test('the load is a share where the line has a rate, else bytes', () => {
  assert.equal(loadText(up({ load: 0.123 })), '12.3 %');
  assert.equal(loadText(up({ load: null, bytes_per_second: 26052 })), '26.1 kB/s');
  assert.equal(loadText(up({ load: null, bytes_per_second: null })), '');
  assert.equal(bytesText(999), '999 B');
  assert.equal(number(0), '0');
});

test('a virtual clock begins at 0, another one in 1970', () => {
  assert.equal(timeText(1_500_012_000), '1.500012 s');
  assert.match(timeText(1763757352123000000), /^\d\d:\d\d:\d\d\.123$/);
  assert.equal(timeText(undefined), '');
});

test('counters that moved come with the largest first', () => {
  assert.deepEqual(countersMoved({ a: 1, b: 5, c: 2 }, { a: 4, b: 5, c: 9 }), [['c', 7], ['a', 3]]);
  assert.deepEqual(countersMoved(undefined, { a: 1 }), [['a', 1]]);
  assert.deepEqual(countersMoved({ a: 1 }, undefined), []);
});

test('an order names the line by its ends', () => assert.deepEqual(lineOrder('cut', 'a', 'b'), ['fault', 'cut', 'a:b']));
test('a name that is too long says that it goes on', () => assert.equal(shortened('right_shoulder_pitch', 8), 'right_s…'));

function overlapping({ nodes, boxWidth, boxHeight }) {
  let count = 0;
  nodes.forEach((a, i) => nodes.slice(i + 1).forEach((b) => {
    if (Math.abs(a.x - b.x) < boxWidth - 0.5 && Math.abs(a.y - b.y) < boxHeight - 0.5) ++count;
  }));
  return count;
}

for (const count of [2, 3, 4, 8, 16, 20, 21, 40, 64, 65, 255])
  for (const width of [320, 700, 1000, 1600])
    test(`${count} nodes in ${width} pixels lie beside each other and inside the picture`, () => {
      const place = layout(count, width);
      assert.equal(overlapping(place), 0);
      assert.ok(place.width <= Math.max(width, 320), `${place.width}`);
      for (const { x, y } of place.nodes) {
        assert.ok(x - place.boxWidth / 2 >= 0 && x + place.boxWidth / 2 <= place.width);
        assert.ok(y - place.boxHeight / 2 >= 0 && y + place.boxHeight / 2 <= place.height);
      }
      assert.equal(place.lines.length, count);
      assert.equal(place.second.length, count);
    });

test('16 nodes are an oval on a desk and rows on a phone', () => {
  assert.equal(layout(16, 900).shape, 'oval');
  assert.equal(layout(16, 360).shape, 'rows');
});

test('a history keeps its seconds, and begins anew when the clock does', () => {
  const history = new History(10);
  for (let t = 0; t <= 30; ++t) history.add(t, t);
  assert.equal(history.points.length, 11);
  assert.deepEqual(history.range(0), [20, 30]);
  history.add(1, 5);
  assert.deepEqual(history.points, [[1, 5]]);
  assert.deepEqual(history.range(2), [4, 6]);
});

test('packets of a timeline are bars on their lines, interrupts marks, our own stand out', () => {
  const event = (ph, tid, ts, name, channel = 'user') => ({ ph, pid: 1, tid, ts, dur: 2, name, args: { channel } });
  const shown = barsOf({ traceEvents: [{ ph: 'M', pid: 1, tid: 7, name: 'thread_name', args: { name: 'a -> b' } }, event('X', 7, 1, 'a -> c'), event('i', 7, 2, 'INT0 b -> a')] });
  assert.deepEqual(shown.lines, ['a -> b']);
  assert.deepEqual(shown.bars.map((bar) => bar.kind), ['data', 'interrupt']);
  const picture = linesPicture(shown, { from: 0, until: 10, own: 'a', bound: 5 });
  assert.ok(!linesPicture({ lines: ['<b>'], bars: [] }, { from: 0, until: 1 }).includes('<b>'), 'a name is text');
  assert.ok(picture.includes('class="own"') && picture.includes('class="bound"') && picture.includes('class="interrupt"'));
});

test('an address brings back what it was made of, and only says what is not usual', () => {
  assert.equal(writeAddress(usual), '');
  const shown = { ...usual, ring: '', nodes: 5, yaml: 'ring: a & b\n#', orders: [[12.5, 'fault', 'cut', 'a:b']], at: 20, paused: true };
  assert.deepEqual({ ...usual, ...readAddress('#' + writeAddress(shown)) }, shown);
});

test('what makes no sense in an address is left out', () => {
  for (const hash of ['nodes=1', 'nodes=[5]', 'pace=0', 'pace=NaN', 'orders={}', 'orders=[[1,2]]', 'orders=[["x","stop"]]', 'load=100', 'at=-1', '__proto__=1', 'rate=1e99', 'x'])
    assert.deepEqual(readAddress(hash), {}, hash);
});

test('each CPU sends as often as the load asks for, since each packet passes each line', () => {
  assert.equal(periodFor(16, { size: 512, rate: 1e9, load: 50 }).toFixed(3), (16 * 4.192 * 2).toFixed(3));
  assert.equal(periodFor(16, { size: 512, rate: 1e9, load: 0 }), 0);
});
