/* A node of the ring for a microcontroller, written from docs/protocol.md: profile *minimal*. No allocation, no
   operating system: all memory is in a tn_node. What moves its bytes is two functions (tn_port) and two calls (tn_came,
   tn_passed). One thread, or one interrupt level, makes all calls. */
#ifndef TINY_NODE_H
#define TINY_NODE_H

#include "tiny_wire.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifndef TN_NODES
#define TN_NODES 16 /* most nodes of a ring; 2 to 255 */
#endif
#ifndef TN_SENDS
#define TN_SENDS 4 /* DATPs of the CPU that may wait */
#endif
#ifndef TN_INTERRUPTS
#define TN_INTERRUPTS 4 /* INTPs that may wait */
#endif

/* Whom a datagram comes from or goes to. Below TN_NODE_ADDRESSES it is the place where the node with this id listens
   (protocol.md section 6.11); all others are the port's own, and are only handed back to it. */
typedef uint64_t tn_address;
enum { TN_NODE_ADDRESSES = 256 };

/* The bytes' way out, and the time. */
typedef struct {
  void* context;
  /* One datagram of up to TN_MOST_DATAGRAM bytes; false if it was not taken. */
  bool (*send)(void* context, tn_address to, const uint8_t* bytes, size_t size);
  /* Milliseconds of a clock that never goes back; it may wrap. */
  uint32_t (*now)(void* context);
} tn_port;

typedef enum {
  TN_DELIVERED,
  TN_REFUSED,
  TN_NO_SUCH_NODE,
  TN_LOST,
  TN_UNCONFIRMED,
  TN_REJECTED,
  TN_CANCELLED
} tn_outcome; /* protocol.md section 4.6 */

/* What the node asks of its CPU, from within tn_came and tn_passed. It may call tn_send and tn_pull from there. */
typedef struct {
  void* context;
  /* Receive buffers that are free for this priority; 0: the packet is refused. (protocol.md section 3.5) */
  unsigned (*free_buffers)(void* context, uint8_t priority);
  void (*take)(void* context, uint8_t source, uint8_t priority, uint8_t channel, const uint8_t* data, size_t size);
  /* Pulls the pin of this factor; false if it is wired to nothing. (protocol.md section 5.3) */
  bool (*pull)(void* context, uint8_t factor, uint8_t source);
  void (*ended)(void* context, unsigned token, tn_outcome outcome);
} tn_cpu;

/* In ms, as in the ring's file. (protocol.md section 7.4) */
typedef struct {
  uint32_t send, stall, idle, silence, first_successor, break_grace, fold_permission, beacon;
  uint32_t refused, refused_backoff, queue;
} tn_times;

extern const tn_times tn_default_times;

typedef struct {
  const char* ring; /* its name */
  uint8_t id;
  uint8_t count;                   /* of nodes, 2 to TN_NODES */
  uint8_t order[TN_NODES];         /* their ids in ring order */
  uint8_t agreement[TN_AGREEMENT]; /* tn_plain_agreement, or from elsewhere */
  uint64_t boot;                   /* boot number: never the same again (protocol.md section 4.8) */
  tn_times times;
} tn_config;

/* The agreement of a ring without joints on lines as fast as the host; pins 0 to 2 do reset, stop, sync. Fill in the
   rest of the configuration first. (protocol.md section 6.13)
   @param names of the nodes, in ring order */
void tn_plain_agreement(tn_config* config, const char* const* names);

/* Names and meanings: protocol.md section 10. */
#define TN_COUNTERS(X)                                                                                                 \
  X(relayed_data)                                                                                                      \
  X(relayed_interrupts) X(sent_data) X(sent_interrupts) X(returned_data) X(returned_interrupts) X(received_data)       \
      X(received_control) X(pins_pulled) X(timeouts) X(retries) X(refusals) X(hellos) X(duplicates)                    \
          X(earlier_incarnation) X(refused_no_buffer) X(refused_joining) X(refused_unwired) X(crc_errors)              \
              X(malformed_packets) X(stray_slices) X(oversize_packets) X(stalled_packets) X(broken_off_packets)        \
                  X(aborts_received) X(dropped_no_output) X(returns_unmatched) X(returns_damaged) X(orphans_hop)       \
                      X(orphans_bypassed) X(control_malformed) X(retries_of_unaware_nodes) X(unknown_peers)            \
                          X(malformed) X(datagrams_duplicate) X(datagrams_lost) X(datagrams_stale) X(datagrams_unsent) \
                              X(input_losses) X(output_losses)

typedef struct {
#define TN_COUNTER(name) uint32_t name;
  TN_COUNTERS(TN_COUNTER)
#undef TN_COUNTER
} tn_counters;

typedef enum { TN_STARTING, TN_JOINING, TN_UP, TN_OPEN_CHAIN } tn_state; /* protocol.md section 8.1 */

/* ---- From here on: how the node keeps its state. Read it, change nothing. ---- */

typedef struct {
  uint64_t session;
  uint32_t since;
} tn_offer;

typedef struct { /* the receiving end of the line */
  bool up, was_up, heard;
  uint8_t sender;
  tn_address from;
  uint64_t session;
  uint32_t next, silent, lost_at;
  tn_offer offers[TN_NODES];
} tn_input;

typedef struct {
  uint32_t number, since, due;
  bool asked, passed_over, busy;
} tn_candidate;

typedef struct { /* the sending end */
  bool up, was_up, heard;
  uint8_t at; /* which candidate: 0 is the successor */
  uint64_t session;
  uint32_t sequence, silent;
  tn_candidate candidates[TN_NODES];
} tn_output;

typedef struct {
  uint8_t sequence;
  bool known, taken, old;
  uint32_t when;
} tn_verdict;

typedef struct { /* what is remembered of a source (protocol.md section 4.10) */
  bool used, by_packet;
  uint8_t source, incarnation;
  bool heard; /* a hello or a beacon: `boot` holds */
  uint64_t boot;
  uint32_t touched;
  tn_verdict verdicts[2][2]; /* kind, broadcast */
} tn_page;

typedef struct {
  uint8_t next, without_verdict;
} tn_number;

typedef struct {
  bool used, sent, repeated;
  uint8_t destination, last; /* DID; PRI or INT */
  uint16_t size;
  unsigned token;
  uint32_t asked_at, due, refused_since, backoff;
  uint8_t data[TN_MOST_DATA];
} tn_send_slot;

typedef struct {
  bool used;
  uint8_t destination, factor;
  unsigned token;
  uint32_t asked_at;
} tn_interrupt_slot;

enum { TN_OF_USER, TN_OF_HELLO, TN_OF_BEACON };

typedef struct {         /* the packet that is out */
  bool out, waits, once; /* waits: its retry, for the line; once: it is not repeated (protocol.md section 4.10) */
  uint8_t of, slot, code, destination, last;
  uint16_t size;
  uint32_t crc, sent_at;
} tn_outstanding;

typedef struct tn_node {
  tn_config config;
  tn_port port;
  tn_cpu cpu;
  tn_counters counters;
  tn_state state;
  uint64_t ring, boot;
  uint32_t random, started, ticked, beaconed;
  bool ever_linked;
  tn_input input;
  tn_output output;
  /* Relay and Receive */
  uint8_t coming[TN_MOST_PACKET];
  uint16_t come;
  bool open;
  uint32_t open_since;
  tn_page pages[TN_NODES];
  tn_number numbers[2][TN_NODES + 1];
  /* Transmit */
  tn_outstanding outstanding[2];
  tn_send_slot sends[TN_SENDS];
  tn_interrupt_slot interrupts[TN_INTERRUPTS];
  unsigned tokens;
  bool hello_wanted, remembers, aware, new_hello, beacon_now;
  uint32_t hello_due;
  uint8_t control[26];
  uint8_t size; /* of the ring, as learned; 0: not known */
  bool in_lost, out_lost;
  /* breaks */
  bool break_known, break_own, grace_runs, drains;
  uint8_t break_before, break_behind;
  uint32_t grace, drain, paced[2];
  uint8_t datagram[TN_MOST_DATAGRAM];
} tn_node;

/* Begins; the configuration is copied. */
void tn_begin(tn_node* node, const tn_config* config, const tn_port* port, const tn_cpu* cpu);

/* A datagram came from there. It is read within the call; its bytes may be anything. */
void tn_came(tn_node* node, tn_address from, const uint8_t* bytes, size_t size);

/* Time has passed: to be called at least every 10 ms; 1 ms is better. */
void tn_passed(tn_node* node);

/* Sends a DATP; its outcome comes through tn_cpu.ended.
   @param channel not 1, at most 63
   @return its token; 0: rejected (protocol.md section 4.6) */
unsigned tn_send(tn_node* node, uint8_t destination, uint8_t priority, uint8_t channel, const uint8_t* data,
                 size_t size);

/* Sends an INTP. @return its token; 0: rejected */
unsigned tn_pull(tn_node* node, uint8_t destination, uint8_t factor);

#ifdef __cplusplus
}
#endif
#endif
