// Where the page's ring is: behind `ringctl view`, which tells by server-sent events and takes orders. In the playground
// the file of this name there takes its place.

/**
 * @param take called by kind with each message @param say a line for the user
 * @return {order(words): a refusal in words or nothing, node(id): all of a node or null,
 *   log(id): the last lines that it printed, or why none are kept}
 */
export function connect(take, say) {
  const events = new EventSource('events');
  for (const [kind, act] of Object.entries(take)) events.addEventListener(kind, (event) => act(JSON.parse(event.data)));
  events.addEventListener('error', () => say("No connection; trying again. If 'ringctl view' was started anew, open the address that it printed."));
  events.addEventListener('open', () => say(''));
  return { order, node, log };
}

async function order(words) {
  try {
    const answer = await fetch('order', { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(words) });
    return answer.ok ? '' : `Refused: ${await answer.text()}`;
  } catch (problem) {
    return `Not sent: ${problem.message}`;
  }
}

async function log(id) {
  const answer = await fetch(`log/${id}`).catch(() => null);
  return answer?.ok ? answer.text() : null;
}

async function node(id) {
  const answer = await fetch(`node/${id}`).catch(() => null);
  return answer?.ok ? answer.json().catch(() => null) : null;
}
