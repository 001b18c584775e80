#include "tiny_link.h"

#include <string.h>

enum { NO_KEY = 11, CONNECT_KEYED = 8, GIVEN_UP = 1000, CONNECT_TICKS = 2 };

static uint32_t drawn(tn_node* node) {
  do {
    node->random ^= node->random << 13;
    node->random ^= node->random >> 17;
    node->random ^= node->random << 5;
    node->random += node->port.now(node->port.context) * 2u;
  } while (node->random == 0);
  return node->random;
}

uint8_t tn_place(const tn_node* node, uint8_t id) {
  const tn_config* config = &node->config;
  uint8_t own = config->count, other = config->count;
  for (uint8_t i = 0; i < config->count; i++) {
    if (config->order[i] == config->id) own = i;
    if (config->order[i] == id) other = i;
  }
  if (other == config->count) return config->count;
  return (uint8_t)((other + config->count - own - 1) % config->count);
}

static uint8_t candidate_id(const tn_node* node, uint8_t place) {
  const tn_config* config = &node->config;
  uint8_t own = 0;
  while (config->order[own] != config->id) own++;
  return config->order[(own + 1u + place) % config->count];
}

static bool send_header(tn_node* node, tn_address to, uint8_t type, uint64_t session, uint8_t refusal,
                        uint32_t sequence, const uint8_t* more, size_t size) {
  tn_header header;
  header.version = 0;
  header.type = type;
  header.sender = node->config.id;
  header.refusal = refusal;
  header.ring = node->ring;
  header.session = session;
  header.sequence = sequence;
  tn_write_header(node->datagram, &header);
  if (size > 0) memmove(node->datagram + TN_HEADER, more, size); /* it may lie there already */
  const bool taken = node->port.send(node->port.context, to, node->datagram, TN_HEADER + size);
  if (!taken) node->counters.datagrams_unsent++;
  return taken;
}

/* ---- the receiving end ---- */

static void lose_input(tn_node* node, uint8_t reason) {
  tn_input* input = &node->input;
  if (!input->up) return;
  send_header(node, input->from, TN_REFUSE, input->session, reason, 0, NULL, 0);
  input->up = false;
  input->lost_at = node->port.now(node->port.context);
  node->counters.input_losses++;
  tn_input_lost(node);
}

/* In lines from here: 1 is the configured predecessor. (protocol.md section 6.8) */
static uint8_t distance(const tn_node* node, uint8_t id) {
  return (uint8_t)(node->config.count - 1 - tn_place(node, id) == 0 ? node->config.count
                                                                    : node->config.count - 1 - tn_place(node, id));
}

static uint32_t other_parts(const tn_node* node, const uint8_t* agreement) {
  uint32_t parts = 0;
  for (unsigned i = 0; i < TN_AGREEMENT / 8; i++)
    if (memcmp(agreement + 8 * i, node->config.agreement + 8 * i, 8) != 0) parts |= 1u << i;
  return parts;
}

/* -1: it is not answered. (protocol.md section 6.8) */
static int judge(const tn_node* node, const tn_header* header, const uint8_t* more, size_t size, uint32_t* parts) {
  if (header->version != 3) return TN_WRONG_VERSION;
  if (header->ring != node->ring) return TN_WRONG_RING;
  if (header->type == CONNECT_KEYED) return NO_KEY;
  if (size < TN_AGREEMENT) return -1;
  *parts = other_parts(node, more);
  if (*parts != 0) return TN_OTHER_RING_FILE;
  if (tn_place(node, header->sender) == node->config.count) return TN_NOT_IN_RING;
  if (node->input.up && distance(node, header->sender) > distance(node, node->input.sender)) return TN_BUSY;
  return TN_NO_REFUSAL;
}

static void asked(tn_node* node, tn_address from, const tn_header* header, const uint8_t* more, size_t size) {
  uint32_t parts = 0;
  const int refusal = judge(node, header, more, size, &parts);
  if (refusal < 0) {
    node->counters.unknown_peers++;
    return;
  }
  if (refusal != TN_NO_REFUSAL) {
    send_header(node, from, TN_REFUSE, header->session, (uint8_t)refusal, parts, NULL, 0);
    return;
  }
  tn_input* input = &node->input;
  tn_offer* offer = &input->offers[tn_place(node, header->sender)];
  const uint32_t number = (uint32_t)(header->session >> 32);
  uint64_t session = offer->session;
  if (input->up && input->sender == header->sender && (uint32_t)(input->session >> 32) == number) {
    session = input->session;
  } else if (session == 0 || (uint32_t)(session >> 32) != number) {
    session = (uint64_t)number << 32 | drawn(node);
    offer->session = session;
  }
  offer->since = node->port.now(node->port.context);
  send_header(node, from, TN_ACCEPT, session, TN_NO_REFUSAL, 0, NULL, 0);
}

/* Whether these slices are of the session that holds; it may begin with them. */
static bool in_session(tn_node* node, tn_address from, const tn_header* header) {
  tn_input* input = &node->input;
  if (input->up && header->session == input->session && header->sender == input->sender) return true;
  const uint8_t place = tn_place(node, header->sender);
  if (place == node->config.count || input->offers[place].session != header->session || header->session == 0) {
    node->counters.datagrams_stale++;
    send_header(node, from, TN_REFUSE, header->session, TN_UNKNOWN_SESSION, 0, NULL, 0);
    return false;
  }
  if (input->up && distance(node, header->sender) > distance(node, input->sender)) {
    send_header(node, from, TN_REFUSE, header->session, TN_BUSY, 0, NULL, 0);
    return false;
  }
  const bool replaced = input->up;
  lose_input(node, TN_REPLACED);
  input->offers[place].session = 0;
  input->up = input->was_up = input->heard = true;
  input->sender = header->sender;
  input->session = header->session;
  input->next = 1;
  input->silent = 0;
  node->ever_linked = true;
  input->from = from;
  tn_input_came(node, replaced);
  return true;
}

static void slices(tn_node* node, tn_address from, const tn_header* header, const uint8_t* bytes, size_t size) {
  if (!in_session(node, from, header)) return;
  tn_input* input = &node->input;
  const uint32_t missing = header->sequence - input->next;
  if (missing >= 0x80000000u) {
    node->counters.datagrams_duplicate++;
    return;
  }
  input->from = from;
  input->heard = true;
  if (missing > 0) {
    node->counters.datagrams_lost += missing;
    tn_gap(node);
  }
  input->next = header->sequence + 1;
  const bool whole = size >= TN_SLICE && bytes[0] == 0xA7 && (size_t)(bytes[2] << 8 | bytes[3]) == size - TN_SLICE &&
                     tn_slice_fits(bytes[1], size - TN_SLICE);
  if (!whole) {
    node->counters.malformed++;
    tn_gap(node);
  } else {
    tn_slice(node, bytes[1], bytes + TN_SLICE, size - TN_SLICE);
  }
}

/* ---- the sending end (protocol.md section 6.9) ---- */

static void lose_output(tn_node* node) {
  if (!node->output.up) return;
  node->output.up = false;
  node->counters.output_losses++;
  tn_output_lost(node);
}

/* Where the candidate said nothing, or no: the next one is tried as well. */
static void pass_over(tn_node* node, tn_candidate* candidate, bool busy) {
  candidate->asked = false;
  candidate->busy = busy;
  candidate->passed_over = !busy;
  candidate->due = node->port.now(node->port.context) + 20u * (1u + (node->config.count - 1u) / 16u);
}

static tn_candidate* asked_by(tn_node* node, const tn_header* header, uint8_t* place) {
  *place = tn_place(node, header->sender);
  if (*place == node->config.count) return NULL;
  tn_candidate* candidate = &node->output.candidates[*place];
  return candidate->asked && (uint32_t)(header->session >> 32) == candidate->number ? candidate : NULL;
}

static void accepted(tn_node* node, const tn_header* header) {
  tn_output* output = &node->output;
  uint8_t place;
  tn_candidate* candidate = asked_by(node, header, &place);
  if (candidate == NULL || (uint32_t)header->session == 0 || (output->up && place >= output->at)) return;
  const bool replaced = output->up;
  if (output->up) {
    send_header(node, candidate_id(node, output->at), TN_BYE, output->session, 0, 0, NULL, 0);
    lose_output(node);
  }
  candidate->asked = candidate->passed_over = candidate->busy = false;
  output->up = output->was_up = output->heard = true;
  output->at = place;
  output->session = header->session;
  output->sequence = 1;
  output->silent = 0;
  node->ever_linked = true;
  tn_link_write(node, TN_IDLE, NULL, 0);
  tn_output_came(node, replaced);
}

static void refused(tn_node* node, const tn_header* header) {
  tn_output* output = &node->output;
  const bool busy = header->refusal == TN_BUSY || header->refusal == TN_REPLACED;
  if (output->up && header->session == output->session) {
    tn_candidate* candidate = &output->candidates[output->at];
    lose_output(node);
    candidate->asked = candidate->passed_over = false;
    candidate->busy = busy;
    candidate->due = node->port.now(node->port.context);
    return;
  }
  uint8_t place;
  tn_candidate* candidate = asked_by(node, header, &place);
  if (candidate != NULL) pass_over(node, candidate, busy);
}

static void ask(tn_node* node, uint8_t place, uint32_t now) {
  tn_candidate* candidate = &node->output.candidates[place];
  if (!candidate->asked) {
    if ((int32_t)(now - candidate->due) < 0) return;
    candidate->asked = true;
    candidate->number = drawn(node);
    candidate->since = candidate->due = now;
  } else if (now - candidate->since >= GIVEN_UP) {
    pass_over(node, candidate, false);
    return;
  } else if (now - candidate->since >= node->config.times.silence) {
    candidate->passed_over = true;
  }
  if ((int32_t)(now - candidate->due) < 0) return;
  candidate->due = now + CONNECT_TICKS * node->config.times.idle;
  send_header(node, candidate_id(node, place), TN_CONNECT, (uint64_t)candidate->number << 32, 0, 0,
              node->config.agreement, TN_AGREEMENT);
}

static void ask_candidates(tn_node* node, uint32_t now) {
  tn_output* output = &node->output;
  const bool only_first = !output->was_up && now - node->started < node->config.times.first_successor;
  const uint8_t end = output->up ? output->at : only_first ? 1 : node->config.count;
  for (uint8_t i = 0; i < end; i++) {
    ask(node, i, now);
    if (!output->candidates[i].passed_over) break; /* it may be alive: nobody beyond it is tried */
  }
}

/* ---- both ---- */

void tn_link_begin(tn_node* node) {
  node->ticked = node->started;
  for (uint8_t i = 0; i < TN_NODES; i++) node->output.candidates[i].due = node->started;
}

static uint32_t silence(bool heard, uint32_t so_far, uint32_t passed, uint32_t idle) {
  return heard ? 0 : so_far + (passed < 2 * idle ? passed : 2 * idle);
}

/* protocol.md section 6.10 */
static void tick(tn_node* node, uint32_t passed, uint32_t now) {
  const tn_times* times = &node->config.times;
  tn_input* input = &node->input;
  tn_output* output = &node->output;
  for (uint8_t i = 0; i < node->config.count; i++)
    if (input->offers[i].session != 0 && now - input->offers[i].since >= 4 * times->silence)
      input->offers[i].session = 0;
  input->silent = silence(input->heard, input->silent, passed, times->idle);
  output->silent = silence(output->heard, output->silent, passed, times->idle);
  input->heard = output->heard = false;
  /* What stood still for so long may have been given up, and the ring has gone on without it. */
  if (input->silent >= times->silence || passed >= times->silence) lose_input(node, TN_UNKNOWN_SESSION);
  if (input->up) send_header(node, input->from, TN_ALIVE, input->session, 0, 0, NULL, 0);
  if (output->up && output->silent >= times->silence) {
    lose_output(node);
    pass_over(node, &output->candidates[output->at], false);
  }
  if (output->up) tn_link_write(node, TN_IDLE, NULL, 0);
}

void tn_link_passed(tn_node* node, uint32_t now) {
  const uint32_t passed = now - node->ticked;
  if (passed >= node->config.times.idle) {
    node->ticked = now;
    tick(node, passed, now);
  }
  ask_candidates(node, now);
}

void tn_link_came(tn_node* node, tn_address from, const uint8_t* bytes, size_t size) {
  tn_header header;
  const bool read = tn_read_header(bytes, size, &header);
  const bool asks = read && (header.type == TN_CONNECT || header.type == CONNECT_KEYED);
  if (!read || (header.ring != node->ring && !asks)) {
    node->counters.unknown_peers++;
    return;
  }
  const uint8_t* more = bytes + TN_HEADER;
  size -= TN_HEADER;
  if (asks) {
    asked(node, from, &header, more, size);
  } else if (header.type == TN_SLICES) {
    slices(node, from, &header, more, size);
  } else if (header.type == TN_BYE) {
    if (node->input.up && header.session == node->input.session && header.sender == node->input.sender)
      lose_input(node, TN_UNKNOWN_SESSION);
  } else if (header.type == TN_ACCEPT) {
    accepted(node, &header);
  } else if (header.type == TN_REFUSE) {
    refused(node, &header);
  } else if (header.type == TN_ALIVE) {
    if (node->output.up && header.session == node->output.session) node->output.heard = true;
  }
}

bool tn_link_write(tn_node* node, uint8_t kind, const uint8_t* bytes, size_t size) {
  tn_output* output = &node->output;
  if (!output->up) return false;
  uint8_t* slice = node->datagram + TN_HEADER;
  slice[0] = 0xA7;
  slice[1] = kind;
  slice[2] = (uint8_t)(size >> 8);
  slice[3] = (uint8_t)size;
  if (size > 0) memmove(slice + TN_SLICE, bytes, size);
  send_header(node, candidate_id(node, output->at), TN_SLICES, output->session, 0, output->sequence++, slice,
              TN_SLICE + size);
  return true;
}
