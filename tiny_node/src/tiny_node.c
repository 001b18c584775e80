#include "tiny_node.h"

#include <string.h>

#include "tiny_link.h"

enum {
  SOP = 0xFB,
  EOP = 0xFD,
  HELLO = 1,
  BEACON = 2,
  /* (sizes), written by docs/generate_reference.py */
  HELLO_SIZE = 10,
  BEACON_SIZE = 26,
  BEACON_WITH_LATCH = 40,
  /* end of it */
  CONTROL = 1 << 2, /* PRI of channel 1, priority 0 */
  ONE_TRY = 1 << 3,
  TRIES = 3,
  MOST_FREE = 254,
  USED_UP = 6,
  OLD_BOOTS = 1000,
  LEAST_DATP = 13,
  RUNNING = 3,
  PACE = 1 /* ms */
};

const tn_times tn_default_times = {100, 50, 50, 250, 200, 200, 200, 100, 1000, 64, 5000};

static uint32_t now_of(const tn_node* node) { return node->port.now(node->port.context); }

static bool due(uint32_t now, uint32_t at) { return (int32_t)(now - at) >= 0; }

static uint8_t least(uint8_t a, unsigned b) { return a < b ? a : (uint8_t)b; }

static bool joined(const tn_node* node) { return node->state == TN_UP || node->state == TN_OPEN_CHAIN; }

/* ---- what is remembered of a source (protocol.md section 4.10) ---- */

static tn_page* known_page(tn_node* node, uint8_t source) {
  for (unsigned i = 0; i < TN_NODES; i++)
    if (node->pages[i].used && node->pages[i].source == source) return &node->pages[i];
  return NULL;
}

/* A strange source may take the page that was not needed for the longest time. */
static tn_page* empty_page(tn_node* node, uint8_t source, uint8_t incarnation) {
  tn_page* page = known_page(node, source);
  for (unsigned i = 0; page == NULL && i < TN_NODES; i++)
    if (!node->pages[i].used) page = &node->pages[i];
  if (page == NULL) {
    page = &node->pages[0];
    for (unsigned i = 1; i < TN_NODES; i++)
      if ((int32_t)(node->pages[i].touched - page->touched) < 0) page = &node->pages[i];
    page->used = false;
  }
  const bool same = page->used;
  const bool heard = same && page->heard;
  const uint64_t boot = same ? page->boot : 0;
  memset(page, 0, sizeof *page);
  page->used = page->by_packet = true;
  page->source = source;
  page->incarnation = incarnation;
  page->heard = heard;
  page->boot = boot;
  page->touched = now_of(node);
  return page;
}

static tn_page* page_of(tn_node* node, uint8_t source, uint8_t incarnation) {
  tn_page* page = known_page(node, source);
  const unsigned ahead = page == NULL ? 1 : (unsigned)(incarnation - page->incarnation) & 3;
  if (ahead == 3) return NULL;
  if (ahead != 0) page = empty_page(node, source, incarnation);
  page->touched = now_of(node);
  return page;
}

static bool is_old(const tn_node* node, const tn_verdict* verdict) {
  return verdict->old || now_of(node) - verdict->when >= node->config.times.send;
}

static void for_each_verdict(tn_node* node, void (*act)(tn_node*, tn_verdict*)) {
  for (unsigned i = 0; i < TN_NODES; i++)
    for (unsigned k = 0; k < 4; k++) act(node, &node->pages[i].verdicts[k / 2][k % 2]);
}

/* The clock may wrap: an age is noted before it does. */
static void note_age(tn_node* node, tn_verdict* verdict) { verdict->old = verdict->known && is_old(node, verdict); }

static void forget_before_loss(tn_node* node, tn_verdict* verdict) {
  if (!node->input.up || (int32_t)(verdict->when - node->input.lost_at) < 0) verdict->known = false;
}

static void four_incarnations_later(tn_node* node, tn_page* page) {
  for (unsigned k = 0; k < 4; k++) {
    tn_verdict* verdict = &page->verdicts[k / 2][k % 2];
    if (now_of(node) - verdict->when > 4 * node->config.times.send) verdict->known = false;
    verdict->old = true;
  }
}

/* ---- ends of sends ---- */

static void tell_end(tn_node* node, unsigned token, tn_outcome outcome) {
  if (node->cpu.ended != NULL) node->cpu.ended(node->cpu.context, token, outcome);
}

static void end_send(tn_node* node, tn_send_slot* slot, tn_outcome outcome) {
  slot->used = false;
  tell_end(node, slot->token, outcome);
}

static void end_interrupt(tn_node* node, tn_interrupt_slot* slot, tn_outcome outcome) {
  slot->used = false;
  tell_end(node, slot->token, outcome);
}

static tn_send_slot* slot_of(tn_node* node, const tn_outstanding* out) { return &node->sends[out->slot]; }

static void hello_is_home(tn_node* node) {
  node->hello_wanted = false;
  if (node->state == TN_JOINING) node->state = TN_UP;
  node->beacon_now = true;
}

/* What is out has ended; a hello goes again one time-out after it was said. (protocol.md section 8.1) */
static void end_outstanding(tn_node* node, bool interrupt, tn_outcome outcome) {
  tn_outstanding* out = &node->outstanding[interrupt];
  if (!out->out) return;
  out->out = out->waits = false;
  if (interrupt)
    end_interrupt(node, &node->interrupts[out->slot], outcome);
  else if (out->of == TN_OF_USER)
    end_send(node, slot_of(node, out), outcome);
  else if (out->of == TN_OF_HELLO && outcome != TN_CANCELLED)
    node->hello_wanted = true;
}

static void end_all(tn_node* node, tn_outcome outcome) {
  end_outstanding(node, false, outcome);
  end_outstanding(node, true, outcome);
  if (outcome != TN_CANCELLED) return;
  for (unsigned i = 0; i < TN_SENDS; i++)
    if (node->sends[i].used) end_send(node, &node->sends[i], outcome);
  for (unsigned i = 0; i < TN_INTERRUPTS; i++)
    if (node->interrupts[i].used) end_interrupt(node, &node->interrupts[i], outcome);
}

/* ---- what goes out ---- */

static uint16_t build(tn_node* node, tn_outstanding* out, bool interrupt) {
  uint8_t* packet = node->datagram + TN_HEADER + TN_SLICE;
  packet[0] = out->code;
  packet[1] = SOP;
  packet[2] = 0;
  packet[3] = node->config.id;
  if (!interrupt) memcpy(packet + 4, out->of == TN_OF_USER ? slot_of(node, out)->data : node->control, out->size - 12u);
  uint8_t* trailer = packet + out->size - 8;
  trailer[0] = EOP;
  trailer[1] = TN_UNTAKEN;
  trailer[2] = out->destination;
  trailer[3] = out->last;
  out->crc = tn_crc(packet, out->size - 4u);
  tn_put32(packet + out->size - 4, out->crc);
  return out->size;
}

/* In an open chain nothing returns. (protocol.md section 8.4) */
static void left_in_chain(tn_node* node, bool interrupt, uint32_t now) {
  tn_outstanding* out = &node->outstanding[interrupt];
  node->paced[interrupt] = now;
  if (out->of == TN_OF_HELLO) {
    out->out = false;
    hello_is_home(node);
  }
  end_outstanding(node, interrupt, TN_UNCONFIRMED);
}

static void launch(tn_node* node, bool interrupt) {
  tn_outstanding* out = &node->outstanding[interrupt];
  const uint32_t now = now_of(node);
  if (!node->output.up) {
    out->waits = true;
    return;
  }
  out->waits = false;
  out->sent_at = now;
  const uint16_t size = build(node, out, interrupt);
  tn_link_write(node, interrupt ? TN_INTERRUPT : TN_WHOLE, node->datagram + TN_HEADER + TN_SLICE, size);
  if (interrupt)
    node->counters.sent_interrupts++;
  else
    node->counters.sent_data++;
  if (node->state == TN_OPEN_CHAIN) left_in_chain(node, interrupt, now);
}

static tn_number* number_of(tn_node* node, bool interrupt, uint8_t destination) {
  const uint8_t place = destination == TN_ALL ? TN_NODES : tn_place(node, destination);
  return &node->numbers[interrupt][place];
}

/* False if a new hello has to come first. (protocol.md section 4.7) */
static bool send_new(tn_node* node, bool interrupt, uint8_t of, uint8_t slot, uint8_t destination, uint8_t last,
                     uint16_t size) {
  tn_number* number = number_of(node, interrupt, destination);
  if (number->without_verdict >= USED_UP && of != TN_OF_HELLO && node->state != TN_OPEN_CHAIN) {
    node->new_hello = true;
    return false;
  }
  tn_outstanding* out = &node->outstanding[interrupt];
  out->out = true;
  out->once = out->waits = false;
  out->of = of;
  out->slot = slot;
  out->destination = destination;
  out->last = last;
  out->size = size;
  out->code = (uint8_t)((node->boot & 3) << 6 | (interrupt ? 1u << 5 : 0u) | number->next);
  number->next = (number->next + 1) & 7;
  if (number->without_verdict < USED_UP) number->without_verdict++;
  launch(node, interrupt);
  return true;
}

static void say_hello(tn_node* node, uint32_t now) {
  node->control[0] = HELLO;
  tn_put64(node->control + 1, node->boot);
  node->control[9] = node->remembers;
  node->hello_wanted = false;
  node->hello_due = now + node->config.times.send;
  node->counters.hellos++;
  send_new(node, false, TN_OF_HELLO, 0, TN_ALL, CONTROL, HELLO_SIZE + 12);
}

/* 0 down, 1 up, 2 silent. (protocol.md section 3.9) */
static uint8_t line_state(bool up, bool was_up) { return up ? 1 : was_up ? 2 : 0; }

static uint8_t neighbour(const tn_node* node, uint8_t place) {
  for (uint8_t i = 0; i < node->config.count; i++)
    if (tn_place(node, node->config.order[i]) == place) return node->config.order[i];
  return node->config.id;
}

static void say_beacon(tn_node* node, uint32_t now) {
  uint8_t* beacon = node->control;
  memset(beacon, 0, BEACON_SIZE);
  beacon[0] = BEACON;
  tn_put64(beacon + 1, node->boot);
  beacon[12] = 1; /* the firmware has started once, and speaks right now */
  beacon[13] = RUNNING;
  beacon[18] = line_state(node->input.up, node->input.was_up);
  beacon[19] = node->input.sender;
  beacon[20] = line_state(node->output.up, node->output.was_up);
  beacon[21] = neighbour(node, node->output.at);
  beacon[22] = node->break_known;
  beacon[23] = node->break_known ? node->break_before : 0;
  beacon[24] = node->break_known ? node->break_behind : 0;
  beacon[25] = 1;
  if (!send_new(node, false, TN_OF_BEACON, 0, TN_ALL, CONTROL, BEACON_SIZE + 12)) return;
  node->beaconed = now;
  node->beacon_now = false;
}

/* By its place in the ring a node takes up to a quarter longer. (protocol.md section 8.2) */
static uint32_t beacon_period(const tn_node* node) {
  const uint32_t period = node->config.times.beacon;
  uint8_t place = 0;
  while (node->config.order[place] != node->config.id) place++;
  return period + period * place / (4u * node->config.count);
}

/* The oldest of a priority, which holds the others back while it waits. (protocol.md section 4.4) */
static tn_send_slot* head(tn_node* node, uint8_t priority) {
  tn_send_slot* first = NULL;
  for (unsigned i = 0; i < TN_SENDS; i++) {
    tn_send_slot* slot = &node->sends[i];
    if (slot->used && (slot->last & 3) == priority && (first == NULL || (int32_t)(slot->token - first->token) < 0))
      first = slot;
  }
  return first;
}

static void send_next_data(tn_node* node, uint32_t now) {
  for (uint8_t priority = 0; priority < 4; priority++) {
    tn_send_slot* slot = head(node, priority);
    if (slot == NULL || !due(now, slot->due)) continue;
    if (send_new(node, false, TN_OF_USER, (uint8_t)(slot - node->sends), slot->destination, slot->last,
                 (uint16_t)(slot->size + 12)))
      slot->sent = true;
    return;
  }
}

static void send_next_interrupt(tn_node* node) {
  tn_interrupt_slot* first = NULL;
  for (unsigned i = 0; i < TN_INTERRUPTS; i++) {
    tn_interrupt_slot* slot = &node->interrupts[i];
    if (slot->used && (first == NULL || (int32_t)(slot->token - first->token) < 0)) first = slot;
  }
  if (first != NULL)
    send_new(node, true, TN_OF_USER, (uint8_t)(first - node->interrupts), first->destination, first->factor,
             TN_INTERRUPT_SIZE);
}

static bool paced(const tn_node* node, bool interrupt, uint32_t now) {
  return node->state != TN_OPEN_CHAIN || now - node->paced[interrupt] > PACE;
}

static void say_new_hello(tn_node* node, uint32_t now) {
  if (node->outstanding[0].out || node->outstanding[1].out) return;
  node->new_hello = false;
  node->boot++;
  memset(node->numbers, 0, sizeof node->numbers);
  node->remembers = true;
  say_hello(node, now);
}

static bool hello_is_out(const tn_node* node) {
  return node->outstanding[0].out && node->outstanding[0].of == TN_OF_HELLO;
}

/* Everything that is due goes. */
static void transmit(tn_node* node, uint32_t now) {
  const bool closed = node->input.up && node->output.up;
  if (node->state == TN_STARTING && closed) {
    node->state = TN_JOINING;
    node->hello_wanted = true;
    node->hello_due = now;
  } else if (node->state == TN_JOINING && node->hello_wanted && !closed) {
    node->state = TN_STARTING;
  }
  if (node->hello_wanted) {
    if ((closed || node->state == TN_OPEN_CHAIN) && node->output.up && due(now, node->hello_due) &&
        !node->outstanding[0].out)
      say_hello(node, now);
    return;
  }
  if (!joined(node) || hello_is_out(node) || !node->output.up) return;
  if (node->new_hello && node->state == TN_UP) {
    say_new_hello(node, now);
    return;
  }
  if (!node->outstanding[0].out && paced(node, false, now)) {
    if (node->beacon_now || now - node->beaconed >= beacon_period(node))
      say_beacon(node, now);
    else
      send_next_data(node, now);
  }
  if (!node->outstanding[1].out && paced(node, true, now)) send_next_interrupt(node);
}

/* A try has failed. (protocol.md section 4.3) */
static void failed(tn_node* node, bool interrupt) {
  tn_outstanding* out = &node->outstanding[interrupt];
  if (!out->out || out->waits) return;
  if (!interrupt && out->of == TN_OF_USER) slot_of(node, out)->repeated = true;
  if (out->once || (out->code >> 3 & 3) == TRIES) {
    end_outstanding(node, interrupt, TN_LOST);
    return;
  }
  out->code = (uint8_t)(out->code + ONE_TRY);
  out->waits = true;
  if (!node->output.up) return;
  node->counters.retries++;
  launch(node, interrupt);
}

/* ---- a source has started again (protocol.md section 4.10) ---- */

static void has_started(tn_node* node, uint8_t source) {
  for (unsigned kind = 0; kind < 2; kind++) {
    tn_outstanding* out = &node->outstanding[kind];
    if (!out->out || out->of != TN_OF_USER || (out->destination != source && out->destination != TN_ALL)) continue;
    out->once = true;
    if (out->waits) end_outstanding(node, kind == 1, TN_LOST);
  }
  for (uint8_t i = 0; i < TN_SENDS; i++) {
    tn_send_slot* slot = &node->sends[i];
    const bool out =
        node->outstanding[0].out && node->outstanding[0].of == TN_OF_USER && node->outstanding[0].slot == i;
    if (slot->used && !out && slot->repeated && slot->destination == source) end_send(node, slot, TN_LOST);
  }
}

/* ---- hellos and beacons ---- */

static bool says_something(const uint8_t* more) {
  for (unsigned i = BEACON_SIZE; i < BEACON_WITH_LATCH; i++)
    if (more[i] != 0) return true;
  return false;
}

static bool is_control(const uint8_t* data, size_t size) {
  if (data[0] == HELLO) return size == HELLO_SIZE && data[9] <= 1;
  if (data[0] != BEACON || (size != BEACON_SIZE && size != BEACON_WITH_LATCH)) return false;
  if (size == BEACON_WITH_LATCH && (data[26] > 1 || !says_something(data))) return false;
  return data[13] <= 5 && data[18] <= 3 && data[20] <= 3 && data[22] <= 1 && data[25] <= 1;
}

static void enter_open_chain(tn_node* node) {
  if (node->state == TN_OPEN_CHAIN || !node->output.up) return;
  const bool hello_pending = !joined(node) || hello_is_out(node) || node->hello_wanted;
  const bool hello_left = hello_is_out(node);
  end_all(node, TN_UNCONFIRMED);
  for (unsigned i = 0; i < TN_SENDS; i++)
    if (node->sends[i].used && node->sends[i].repeated) end_send(node, &node->sends[i], TN_UNCONFIRMED);
  node->state = TN_OPEN_CHAIN;
  node->hello_wanted = hello_pending && !hello_left;
  node->hello_due = now_of(node);
  node->beacon_now = true;
}

/* protocol.md section 8.3 */
static void hear_of_break(tn_node* node, uint8_t source, const uint8_t* beacon) {
  if (node->break_own) return;
  if (beacon[22] == 1 && beacon[24] == source) {
    node->drains = false;
    node->break_known = true;
    node->break_before = beacon[23];
    node->break_behind = source;
    if (beacon[18] != 3) enter_open_chain(node);
  } else if (beacon[22] == 0 && source == node->break_behind && node->state != TN_OPEN_CHAIN) {
    node->break_known = false;
  }
}

/* Another node's beacon takes the own one along. (protocol.md section 8.2) */
static void go_along(tn_node* node) {
  const uint32_t period = beacon_period(node);
  const uint32_t left = period - (now_of(node) - node->beaconed);
  if (joined(node) && !node->outstanding[0].out &&
      left <= node->config.times.beacon / 2 + period - node->config.times.beacon)
    node->beacon_now = true;
}

static void new_boot(tn_node* node, tn_page* page, uint8_t source, const uint8_t* data) {
  const uint64_t boot = tn_get64(data + 1);
  const bool hello = data[0] == HELLO, heard = page != NULL && page->heard;
  const bool remembers = hello && data[9] == 1 && heard && boot == page->boot + 1;
  if ((heard || hello) && !remembers) has_started(node, source);
  if (hello || page == NULL || page->incarnation != (boot & 3))
    page = empty_page(node, source, (uint8_t)(boot & 3));
  else if (!page->by_packet)
    four_incarnations_later(node, page);
  page->by_packet = false;
  page->heard = true;
  page->boot = boot;
}

/* False if it is of an earlier incarnation. */
static bool hear(tn_node* node, uint8_t source, const uint8_t* data, size_t size) {
  if (!is_control(data, size)) {
    node->counters.control_malformed++;
    return true;
  }
  const uint64_t boot = tn_get64(data + 1);
  tn_page* page = known_page(node, source);
  const bool heard = page != NULL && page->heard;
  if (heard && page->boot > boot && page->boot - boot <= OLD_BOOTS) return false;
  if (!heard || page->boot != boot) new_boot(node, page, source, data);
  if (data[0] == BEACON) {
    hear_of_break(node, source, data);
    go_along(node);
  }
  return true;
}

/* ---- Receive ---- */

static unsigned free_buffers(tn_node* node, uint8_t priority) {
  const unsigned free = node->cpu.free_buffers == NULL ? 0 : node->cpu.free_buffers(node->cpu.context, priority);
  return free < MOST_FREE ? free : MOST_FREE;
}

/* The FBC of a DATP of the user that is decided now; 0: refused. */
static unsigned decide_data(tn_node* node, const uint8_t* packet, size_t size) {
  const uint8_t last = packet[size - 5];
  if (!joined(node)) {
    node->counters.refused_joining++;
    return 0;
  }
  const unsigned free = free_buffers(node, last & 3);
  if (free == 0) {
    node->counters.refused_no_buffer++;
    return 0;
  }
  node->counters.received_data++;
  node->cpu.take(node->cpu.context, packet[3], last & 3, last >> 2, packet + 4, size - 12);
  return free;
}

static unsigned decide_interrupt(tn_node* node, const uint8_t* packet) {
  const uint8_t factor = packet[7] & 7;
  if (node->cpu.pull == NULL || !node->cpu.pull(node->cpu.context, factor, packet[3])) {
    node->counters.refused_unwired++;
    return 0;
  }
  node->counters.pins_pulled++;
  return 1;
}

static unsigned same_verdict(tn_node* node, const tn_verdict* verdict, bool interrupt, uint8_t last) {
  node->counters.duplicates++;
  if (!verdict->taken) return 0;
  const unsigned free = interrupt ? 1 : free_buffers(node, last & 3);
  return free > 0 ? free : 1;
}

/* The FBC with which a packet that is addressed to this node goes on. (protocol.md sections 2.3, 3.5 and 4.10) */
static uint8_t answer(tn_node* node, const uint8_t* packet, size_t size, bool interrupt) {
  const uint8_t fbc = packet[size - 7], last = packet[size - 5], sequence = packet[0] & 7;
  const bool control = !interrupt && last >> 2 == 1, retry = (packet[0] >> 3 & 3) != 0;
  tn_page* page = page_of(node, packet[3], packet[0] >> 6);
  if (page == NULL) {
    node->counters.earlier_incarnation++;
    return 0;
  }
  tn_verdict* verdict = &page->verdicts[interrupt][packet[size - 6] == TN_ALL];
  const bool known = verdict->known && verdict->sequence == sequence;
  if (!control) {
    if (known && (retry || !is_old(node, verdict))) return least(fbc, same_verdict(node, verdict, interrupt, last));
    if (retry && !node->aware && !known) {
      node->counters.retries_of_unaware_nodes++;
      return fbc;
    }
  }
  unsigned value = MOST_FREE;
  if (control)
    node->counters.received_control++;
  else
    value = interrupt ? decide_interrupt(node, packet) : decide_data(node, packet, size);
  verdict->known = true;
  verdict->sequence = sequence;
  verdict->taken = value > 0;
  verdict->old = false;
  verdict->when = now_of(node);
  return least(fbc, value);
}

static uint8_t receive(tn_node* node, const uint8_t* packet, size_t size, bool interrupt) {
  const uint8_t fbc = packet[size - 7], destination = packet[size - 6];
  const bool addressed = destination == node->config.id || (destination == TN_ALL && packet[3] != node->config.id);
  if (!interrupt && packet[size - 5] >> 2 == 1 && !hear(node, packet[3], packet + 4, size - 12)) {
    node->counters.earlier_incarnation++;
    return addressed ? 0 : fbc;
  }
  return addressed ? answer(node, packet, size, interrupt) : fbc;
}

/* ---- the own packet comes home ---- */

static bool matches(const tn_outstanding* out, const uint8_t* packet, size_t size) {
  return out->out && packet[0] == (out->waits ? out->code - ONE_TRY : out->code) && size == out->size &&
         packet[size - 6] == out->destination && packet[size - 5] == out->last &&
         tn_crc_as_sent(packet, size) == out->crc;
}

/* It waits, and goes again as a new packet. (protocol.md section 4.4) */
static bool goes_again(tn_node* node, tn_outstanding* out, uint32_t now) {
  tn_send_slot* slot = slot_of(node, out);
  if (out->destination == TN_ALL || (out->once && slot->repeated)) return false;
  if (slot->backoff == 0)
    slot->refused_since = now;
  else if (now - slot->refused_since >= node->config.times.refused)
    return false;
  node->counters.refusals++;
  slot->backoff = slot->backoff == 0 ? 1 : 2 * slot->backoff;
  if (slot->backoff > node->config.times.refused_backoff) slot->backoff = node->config.times.refused_backoff;
  slot->due = now + slot->backoff;
  const uint32_t last = slot->refused_since + node->config.times.refused;
  if (due(slot->due, last)) slot->due = last;
  out->out = out->waits = false;
  return true;
}

static void confirmed(tn_node* node, bool interrupt, uint8_t fbc) {
  tn_outstanding* out = &node->outstanding[interrupt];
  const bool repeated = interrupt || out->of != TN_OF_USER ? (out->code >> 3 & 3) != 0 : slot_of(node, out)->repeated;
  if (fbc != TN_UNTAKEN) number_of(node, interrupt, out->destination)->without_verdict = 0;
  if (!interrupt && out->of != TN_OF_USER) {
    const bool hello = out->of == TN_OF_HELLO;
    out->out = out->waits = false;
    node->aware = true;
    if (hello) hello_is_home(node);
    return;
  }
  if (!interrupt && fbc == 0 && goes_again(node, out, now_of(node))) return;
  end_outstanding(node, interrupt,
                  fbc > 0 && fbc < TN_UNTAKEN ? TN_DELIVERED
                  : repeated                  ? TN_LOST
                  : fbc == 0                  ? TN_REFUSED
                                              : TN_NO_SUCH_NODE);
}

static void is_home(tn_node* node, const uint8_t* packet) {
  node->size = (uint8_t)(packet[2] + 1);
  node->in_lost = !node->input.up;
  node->out_lost = !node->output.up;
}

/* The own hello or beacon shows that the ring is closed again. (protocol.md section 8.4) */
static bool closes_chain(tn_node* node, const uint8_t* packet, size_t size, bool interrupt) {
  if (node->state != TN_OPEN_CHAIN || interrupt || packet[size - 5] != CONTROL || size < HELLO_SIZE + 12 ||
      tn_get64(packet + 5) != node->boot)
    return false;
  is_home(node, packet);
  node->aware = true;
  if (!node->drains) node->drain = now_of(node) + node->config.times.send;
  node->drains = true;
  return true;
}

static void came_home(tn_node* node, uint8_t* packet, size_t size, bool interrupt) {
  if (closes_chain(node, packet, size, interrupt)) return;
  tn_outstanding* out = &node->outstanding[interrupt];
  if (!matches(out, packet, size)) {
    node->counters.returns_unmatched++;
    return;
  }
  is_home(node, packet);
  if (interrupt)
    node->counters.returned_interrupts++;
  else
    node->counters.returned_data++;
  if (out->destination == node->config.id && joined(node)) packet[size - 7] = receive(node, packet, size, interrupt);
  confirmed(node, interrupt, packet[size - 7]);
}

/* ---- Relay (protocol.md section 2.2) ---- */

static void damaged_return(tn_node* node, bool interrupt) {
  node->counters.returns_damaged++;
  failed(node, interrupt);
}

static void pass_on(tn_node* node, uint8_t* packet, size_t size, bool interrupt, uint8_t fbc) {
  if (node->output.up && tn_place(node, packet[3]) < node->output.at) {
    node->counters.orphans_bypassed++;
    return;
  }
  tn_patch(packet, size, (uint8_t)(packet[2] + 1), fbc);
  if (!tn_link_write(node, interrupt ? TN_INTERRUPT : TN_WHOLE, packet, size))
    node->counters.dropped_no_output++;
  else if (interrupt)
    node->counters.relayed_interrupts++;
  else
    node->counters.relayed_data++;
}

static void relay(tn_node* node, uint8_t* packet, size_t size, bool interrupt) {
  if ((packet[0] >> 5 & 1) != interrupt || packet[1] != SOP || packet[3] == TN_ALL) {
    node->counters.malformed_packets++;
    return;
  }
  const bool right = tn_crc(packet, size - 4) == tn_get32(packet + size - 4), ends = packet[size - 8] == EOP;
  if (!right)
    node->counters.crc_errors++;
  else if (!ends)
    node->counters.malformed_packets++;
  if (packet[3] == node->config.id) {
    if (right && ends)
      came_home(node, packet, size, interrupt);
    else
      damaged_return(node, interrupt);
    return;
  }
  if (packet[2] + 1 >= node->config.count) {
    node->counters.orphans_hop++;
    return;
  }
  const uint8_t fbc = right && ends ? receive(node, packet, size, interrupt) : packet[size - 7];
  pass_on(node, packet, size, interrupt, fbc);
}

/* ---- slices (protocol.md sections 2.6 and 6.3) ---- */

static void break_off(tn_node* node, uint32_t* counter) {
  if (!node->open) return;
  node->open = false;
  (*counter)++;
  if (node->coming[3] == node->config.id) damaged_return(node, false);
}

static void add_bytes(tn_node* node, const uint8_t* bytes, size_t size) {
  memcpy(node->coming + node->come, bytes, size);
  node->come = (uint16_t)(node->come + size);
  node->open_since = now_of(node);
}

static void goes_on(tn_node* node, uint8_t kind, const uint8_t* bytes, size_t size) {
  if (!node->open) {
    node->counters.stray_slices++;
  } else if (kind == TN_ABORT) {
    break_off(node, &node->counters.aborts_received);
  } else if (node->come + size > (kind == TN_END ? TN_MOST_PACKET : TN_MOST_PACKET - 8)) {
    break_off(node, &node->counters.oversize_packets);
  } else if (kind == TN_END && node->come + size < LEAST_DATP) {
    break_off(node, &node->counters.malformed_packets);
  } else {
    add_bytes(node, bytes, size);
    if (kind != TN_END) return;
    node->open = false;
    relay(node, node->coming, node->come, false);
  }
}

void tn_slice(tn_node* node, uint8_t kind, const uint8_t* bytes, size_t size) {
  if (kind == TN_INTERRUPT) {
    uint8_t packet[TN_INTERRUPT_SIZE];
    memcpy(packet, bytes, size);
    relay(node, packet, size, true);
  } else if (kind == TN_WHOLE || kind == TN_START) {
    break_off(node, &node->counters.broken_off_packets);
    node->come = 0;
    add_bytes(node, bytes, size);
    node->open = kind == TN_START;
    if (kind == TN_WHOLE) relay(node, node->coming, node->come, false);
  } else if (kind == TN_MORE || kind == TN_END || kind == TN_ABORT) {
    goes_on(node, kind, bytes, size);
  }
}

/* ---- lines that come and go ---- */

void tn_gap(tn_node* node) { break_off(node, &node->counters.broken_off_packets); }

static void line_came(tn_node* node) {
  node->beacon_now = true;
  if (node->state != TN_JOINING || !node->input.up || !node->output.up) return;
  end_all(node, TN_CANCELLED);
  node->hello_wanted = true;
  node->hello_due = now_of(node);
}

/* Perhaps it was bypassed. (protocol.md sections 4.8 and 4.10) */
static void start_over(tn_node* node) {
  for_each_verdict(node, forget_before_loss);
  node->boot++;
  node->state = TN_STARTING;
  end_all(node, TN_CANCELLED);
  memset(node->numbers, 0, sizeof node->numbers);
  node->in_lost = node->out_lost = node->aware = node->remembers = node->new_hello = node->hello_wanted = false;
  node->break_known = node->break_own = node->grace_runs = node->drains = false;
  node->size = 0;
}

static void watch_break(tn_node* node) {
  if (node->input.up || !node->input.was_up || !node->output.up || node->grace_runs || node->break_own) return;
  node->grace_runs = true;
  node->grace = now_of(node) + node->config.times.break_grace;
}

static void line_lost(tn_node* node) {
  node->beacon_now = true;
  if (node->in_lost && node->out_lost) start_over(node);
}

void tn_input_came(tn_node* node, bool replaced) {
  (void)replaced;
  node->grace_runs = false;
  if (node->break_own) node->break_known = false;
  node->break_own = false;
  line_came(node);
}

void tn_input_lost(tn_node* node) {
  tn_gap(node);
  node->in_lost = true;
  line_lost(node);
  watch_break(node);
}

void tn_output_came(tn_node* node, bool replaced) {
  (void)replaced;
  watch_break(node);
  line_came(node);
}

void tn_output_lost(tn_node* node) {
  node->out_lost = true;
  node->grace_runs = false;
  line_lost(node);
}

/* ---- time ---- */

static void watch_returns(tn_node* node, uint32_t now) {
  for (unsigned kind = 0; kind < 2; kind++) {
    tn_outstanding* out = &node->outstanding[kind];
    if (!out->out) continue;
    if (out->waits) {
      if (now - out->sent_at >= node->config.times.queue) {
        end_outstanding(node, kind == 1, TN_LOST);
      } else if (node->output.up) {
        node->counters.retries++;
        launch(node, kind == 1);
      }
    } else if (now - out->sent_at >= node->config.times.send) {
      node->counters.timeouts++;
      failed(node, kind == 1);
    }
  }
}

/* protocol.md section 4.5 */
static void watch_queues(tn_node* node, uint32_t now) {
  for (uint8_t i = 0; i < TN_SENDS; i++) {
    tn_send_slot* slot = &node->sends[i];
    const tn_outstanding* out = &node->outstanding[0];
    if (!slot->used || now - slot->asked_at < node->config.times.queue) continue;
    if (out->out && out->of == TN_OF_USER && out->slot == i) continue;
    end_send(node, slot, !slot->sent ? TN_REJECTED : slot->repeated ? TN_LOST : TN_REFUSED);
  }
  for (uint8_t i = 0; i < TN_INTERRUPTS; i++) {
    tn_interrupt_slot* slot = &node->interrupts[i];
    if (!slot->used || now - slot->asked_at < node->config.times.queue) continue;
    if (!node->outstanding[1].out || node->outstanding[1].slot != i) end_interrupt(node, slot, TN_REJECTED);
  }
}

static void watch_breaks(tn_node* node, uint32_t now) {
  if (node->grace_runs && due(now, node->grace)) {
    node->grace_runs = false;
    node->break_own = node->break_known = true;
    node->break_before = node->input.sender;
    node->break_behind = node->config.id;
    node->drains = false;
    node->beacon_now = true;
    enter_open_chain(node);
  }
  if (node->drains && due(now, node->drain)) {
    node->drains = node->break_known = node->break_own = false;
    node->state = TN_UP;
    node->new_hello = true;
  }
}

void tn_passed(tn_node* node) {
  const uint32_t now = now_of(node);
  tn_link_passed(node, now);
  if (node->open && now - node->open_since >= node->config.times.stall)
    break_off(node, &node->counters.stalled_packets);
  for_each_verdict(node, note_age);
  watch_breaks(node, now);
  watch_returns(node, now);
  watch_queues(node, now);
  transmit(node, now);
}

void tn_came(tn_node* node, tn_address from, const uint8_t* bytes, size_t size) {
  tn_link_passed(node, now_of(node));
  tn_link_came(node, from, bytes, size);
  transmit(node, now_of(node));
}

/* ---- the CPU ---- */

static bool may_send(const tn_node* node, uint8_t destination) {
  return joined(node) && (destination == TN_ALL || tn_place(node, destination) < node->config.count);
}

static unsigned next_token(tn_node* node) { return ++node->tokens != 0 ? node->tokens : ++node->tokens; }

unsigned tn_send(tn_node* node, uint8_t destination, uint8_t priority, uint8_t channel, const uint8_t* data,
                 size_t size) {
  if (size == 0 || size > TN_MOST_DATA || priority > 3 || channel > 63 || channel == 1 || !may_send(node, destination))
    return 0;
  for (unsigned i = 0; i < TN_SENDS; i++) {
    tn_send_slot* slot = &node->sends[i];
    if (slot->used) continue;
    slot->used = true;
    slot->sent = slot->repeated = false;
    slot->destination = destination;
    slot->last = (uint8_t)(channel << 2 | priority);
    slot->size = (uint16_t)size;
    slot->token = next_token(node);
    slot->asked_at = slot->due = now_of(node);
    slot->backoff = 0;
    memcpy(slot->data, data, size);
    return slot->token;
  }
  return 0;
}

unsigned tn_pull(tn_node* node, uint8_t destination, uint8_t factor) {
  if (factor > 7 || !may_send(node, destination)) return 0;
  for (unsigned i = 0; i < TN_INTERRUPTS; i++) {
    tn_interrupt_slot* slot = &node->interrupts[i];
    if (slot->used) continue;
    slot->used = true;
    slot->destination = destination;
    slot->factor = factor;
    slot->token = next_token(node);
    slot->asked_at = now_of(node);
    return slot->token;
  }
  return 0;
}

void tn_begin(tn_node* node, const tn_config* config, const tn_port* port, const tn_cpu* cpu) {
  memset(node, 0, sizeof *node);
  node->config = *config;
  node->port = *port;
  node->cpu = *cpu;
  node->ring = tn_hash(TN_FNV, config->ring);
  node->boot = config->boot;
  node->random = (uint32_t)(config->boot ^ config->boot >> 32) | 1u;
  node->started = node->beaconed = now_of(node);
  tn_link_begin(node);
}

/* ---- the agreement of a plain ring ---- */

static uint64_t hash_number(uint64_t so_far, uint32_t number) {
  char digits[11];
  unsigned at = sizeof digits - 1;
  digits[at] = '\0';
  do digits[--at] = (char)('0' + number % 10);
  while ((number /= 10) > 0);
  return tn_hash(so_far, digits + at);
}

/* A line for each node: its id, and these words. */
static uint64_t hash_lines(const tn_config* config, const char* const* names, const char* words) {
  uint64_t hash = TN_FNV;
  for (uint8_t i = 0; i < config->count; i++) {
    hash = hash_number(hash, config->order[i]);
    if (names != NULL) hash = tn_hash(tn_hash(hash, " "), names[i]);
    hash = tn_hash(tn_hash(hash, words), "\n");
  }
  return hash;
}

void tn_plain_agreement(tn_config* config, const char* const* names) {
  const tn_times* t = &config->times;
  const uint32_t times[] = {t->send,        t->stall,           t->idle,  t->silence, t->first_successor,
                            t->break_grace, t->fold_permission, t->beacon};
  uint64_t hash = TN_FNV;
  for (unsigned i = 0; i < sizeof times / sizeof *times; i++) hash = tn_hash(hash_number(hash, times[i]), "\n");
  tn_put64(config->agreement, hash_lines(config, names, ""));
  tn_put64(config->agreement + 8, tn_hash(TN_FNV, "none\n"));
  tn_put64(config->agreement + 16, hash);
  tn_put64(config->agreement + 24, hash_lines(config, NULL, " 0 0"));
  tn_put64(config->agreement + 32, hash_lines(config, NULL, ""));
  tn_put64(config->agreement + 40, hash_lines(config, NULL, " reset stop sync none none none none none"));
  tn_put64(config->agreement + 48, tn_hash(hash_number(TN_FNV, config->order[0]), "\n"));
}
