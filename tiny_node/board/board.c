/* The node on a Cortex-M3, over its UART: Stellaris LM3S6965, as QEMU has it (-machine lm3s6965evb). Built with the
   ring in BOARD_RING, this node in BOARD_NODE and the ids of all in BOARD_IDS; BOARD_AGREEMENT is 56 bytes, without it
   the ring is a plain one of node0, node1, .... It stores nothing, so it asks the other end for a boot number. Pin 0
   resets the board, pin 1 stops its joint. Its watchdog pulls pin 3 of the first node. */
#include <string.h>

#include "tiny_frame.h"
#include "tiny_node.h"

#ifndef BOARD_RING
#define BOARD_RING "board"
#define BOARD_NODE 1
#define BOARD_IDS 0, 1, 2
#endif

enum {
  FREE_BUFFERS = 4,
  ASK_EVERY = 100 /* ms */,
  TICKS = 12500 /* of 12.5 MHz: 1 ms */,
  WATCHDOG = 500 /* ms */,
  UART_IRQ = 5,
  WATCHDOG_IRQ = 18,
  UART_CAME = 0x50 /* bytes have come, and few that wait */,
  RX_EMPTY = 1 << 4,
  TX_FULL = 1 << 5
};

#define REGISTER(address) (*(volatile uint32_t*)(address))
#define UART_DATA REGISTER(0x4000C000)
#define UART_FLAGS REGISTER(0x4000C018)
#define UART_BAUD REGISTER(0x4000C024)
#define UART_FRACTION REGISTER(0x4000C028)
#define UART_LINE REGISTER(0x4000C02C)
#define UART_CONTROL REGISTER(0x4000C030)
#define WATCHDOG_LOAD REGISTER(0x40000000)
#define WATCHDOG_CONTROL REGISTER(0x40000008)
#define WATCHDOG_CLEAR REGISTER(0x4000000C)
#define UART_INTERRUPTS REGISTER(0x4000C038)
#define CLOCK_WATCHDOG REGISTER(0x400FE100)
#define CLOCK_UARTS REGISTER(0x400FE104)
#define CLOCK_PORTS REGISTER(0x400FE108)
#define PORT_A_FUNCTION REGISTER(0x40004420)
#define PORT_A_DIGITAL REGISTER(0x4000451C)
#define SYSTICK_CONTROL REGISTER(0xE000E010)
#define SYSTICK_RELOAD REGISTER(0xE000E014)
#define INTERRUPT_ENABLE REGISTER(0xE000E100)
#define RESET_CONTROL REGISTER(0xE000ED0C)

static tn_node node;
static tn_frame_reader reader;
static volatile uint32_t milliseconds;
static uint64_t boot;
static bool reset_wanted, cpu_hangs;
static volatile bool watchdog_barks;

/* ---- the board ---- */

void systick(void);
void systick(void) { milliseconds++; }

void watchdog(void);
void watchdog(void) {
  WATCHDOG_CLEAR = 1;
  watchdog_barks = true;
}

/* Only wakes the main loop, which reads. */
void uart(void);
void uart(void) { UART_INTERRUPTS = 0; }

static void sleep(void) {
  UART_INTERRUPTS = UART_CAME;
  __asm volatile("wfi"); /* the next millisecond wakes it, too */
}

static void feed_watchdog(void) { WATCHDOG_LOAD = (uint32_t)WATCHDOG * TICKS; }

static void start_board(void) {
  CLOCK_WATCHDOG |= 1 << 3;
  feed_watchdog();
  WATCHDOG_CONTROL = 1; /* an interrupt, and no reset: that is for whoever its pin tells */
  INTERRUPT_ENABLE = 1u << WATCHDOG_IRQ | 1u << UART_IRQ;
  CLOCK_UARTS |= 1;
  CLOCK_PORTS |= 1;
  PORT_A_FUNCTION |= 3;
  PORT_A_DIGITAL |= 3;
  UART_CONTROL = 0;
  UART_BAUD = 6; /* 12.5 MHz / 16 / 115200 = 6.78 */
  UART_FRACTION = 50;
  UART_LINE = 0x70; /* 8 bits, no parity, FIFOs */
  UART_CONTROL = 0x301;
  SYSTICK_RELOAD = TICKS - 1;
  SYSTICK_CONTROL = 7;
}

static void put_byte(void* context, uint8_t byte) {
  (void)context;
  while (UART_FLAGS & TX_FULL) continue;
  UART_DATA = byte;
}

/* ---- the port ---- */

static bool send_datagram(void* context, tn_address to, const uint8_t* bytes, size_t size) {
  tn_write_frame((uint16_t)to, bytes, size, put_byte, context);
  return true;
}

static uint32_t now(void* context) {
  (void)context;
  return milliseconds;
}

/* ---- the CPU's joint: one, which follows its commands (protocol.md sections 9.1 and 9.3) ----

   The board has no clock of the day. It counts on from the stamp of the newest command, so it cannot know that one is
   too old, and says its state only once it was told something, to whoever told it. */

enum {
  JOINTS = 2 /* channel */,
  STATE = 1,
  COMMAND = 2,
  SET = 5,
  STATE_SIZE = 28,
  STATE_EVERY = 10 /* ms */,
  COMMAND_HOLDS = 200 /* ms: timeouts.command */,
  SERVO = 8 /* it goes 1/8 of its way in each state period */
};
enum { COMMANDED = 1, SAFE = 2, HOLD = 4, STOPPED = 16 };

static struct {
  bool told, stopped;
  uint8_t master;
  uint16_t sequence;
  int32_t position, velocity, goal; /* 1e-6 rad, rad/s */
  uint64_t stamp, stopped_at;       /* ns */
  uint32_t told_at, said_at;        /* ms */
} joint;

static uint64_t day_time(void) { return joint.stamp + (uint64_t)(milliseconds - joint.told_at) * 1000000u; }

static void obey(uint8_t source, const uint8_t* command, const uint8_t* value, bool resumes) {
  const uint64_t stamp = tn_get64(command + 4);
  if (joint.told && stamp <= joint.stamp) return;
  if (joint.stopped && !(resumes && stamp > joint.stopped_at)) return;
  joint.stopped = false;
  if (!joint.told) joint.said_at = milliseconds;
  joint.told = true;
  joint.master = source;
  joint.stamp = stamp;
  joint.told_at = milliseconds;
  if (value[0] & 1) joint.goal = (int32_t)tn_get32(value + 1);
}

/* Bytes of the values that follow this mask, with it. */
static size_t value_size(uint8_t mask) { return 1u + 4u * ((mask & 1u) + (mask >> 1 & 1u) + (mask >> 2 & 1u)); }

/* Of a command set, the part for this node. */
static void read_set(uint8_t source, const uint8_t* data, size_t size) {
  size_t at = 18;
  for (uint8_t part = 0; part < data[17]; part++) {
    if (at + 2 > size) return;
    const uint8_t whose = data[at], count = data[at + 1];
    at += 2;
    for (uint8_t i = 0; i < count; i++) {
      if (at + 1 > size || at + value_size(data[at]) > size) return;
      if (whose == BOARD_NODE && i == 0 && count == 1) obey(source, data, data + at, false);
      at += value_size(data[at]);
    }
  }
}

static void read_joint_data(uint8_t source, const uint8_t* data, size_t size) {
  if (size < 18 || data[1] != 1) return;
  if (data[0] == SET) read_set(source, data, size);
  if (data[0] == COMMAND && data[17] == 0 && (data[16] & 1)) joint.stopped = false;
  if (data[0] == COMMAND && data[17] == 1 && size >= 19 && size == 18 + value_size(data[18]))
    obey(source, data, data + 18, data[16] & 1);
}

static void move_joint(void) {
  if (!joint.told || milliseconds - joint.said_at < STATE_EVERY) return;
  joint.said_at = milliseconds;
  const bool safe = joint.stopped || milliseconds - joint.told_at > COMMAND_HOLDS;
  const int32_t step = safe ? 0 : (joint.goal - joint.position) / SERVO;
  joint.position += step;
  joint.velocity = step * (1000 / STATE_EVERY);
  uint8_t state[STATE_SIZE] = {STATE, 1, (uint8_t)(joint.sequence >> 8), (uint8_t)joint.sequence};
  tn_put64(state + 4, day_time());
  state[12] = (uint8_t)((safe ? SAFE | HOLD : COMMANDED) | (joint.stopped ? STOPPED : 0));
  state[13] = 1;
  tn_put32(state + 16, (uint32_t)joint.position);
  tn_put32(state + 20, (uint32_t)joint.velocity);
  if (tn_send(&node, joint.master, 0, JOINTS, state, sizeof state) != 0) joint.sequence++;
}

/* ---- the CPU: sends each packet of channel 0 back, but for "hang" ---- */

static unsigned free_buffers(void* context, uint8_t priority) {
  (void)context, (void)priority;
  return cpu_hangs ? 0 : FREE_BUFFERS;
}

static void take(void* context, uint8_t source, uint8_t priority, uint8_t channel, const uint8_t* data, size_t size) {
  (void)context;
  if (channel == JOINTS)
    read_joint_data(source, data, size);
  else if (channel == 0 && size == 4 && memcmp(data, "hang", 4) == 0)
    cpu_hangs = true;
  else if (channel == 0)
    tn_send(&node, source, priority, channel, data, size);
}

static bool pull(void* context, uint8_t factor, uint8_t source) {
  (void)context, (void)source;
  if (factor == 0) reset_wanted = true;
  if (factor == 1) {
    joint.stopped = true;
    joint.stopped_at = day_time();
  }
  return factor <= 2;
}

/* A CPU that hangs does not come by here. */
static void run_cpu(void) {
  feed_watchdog();
  if (boot != 0) move_joint();
}

static void send_bark(void) {
  enum { NOTIFY = 3 };
  if (!watchdog_barks || boot == 0) return;
  watchdog_barks = false;
  tn_pull(&node, node.config.order[0], NOTIFY);
}

static void begin(void) {
  static const uint8_t kIds[] = {BOARD_IDS};
  static tn_config config;
  config.ring = BOARD_RING;
  config.id = BOARD_NODE;
  config.count = sizeof kIds;
  memcpy(config.order, kIds, sizeof kIds);
  config.times = tn_default_times;
  config.boot = boot;
#ifdef BOARD_AGREEMENT
  static const uint8_t kAgreement[TN_AGREEMENT] = {BOARD_AGREEMENT};
  memcpy(config.agreement, kAgreement, sizeof kAgreement);
#else
  static const char* const kNames[] = {"node0", "node1", "node2",  "node3",  "node4",  "node5",  "node6",  "node7",
                                       "node8", "node9", "node10", "node11", "node12", "node13", "node14", "node15"};
  tn_plain_agreement(&config, kNames);
#endif
  const tn_port port = {NULL, send_datagram, now};
  const tn_cpu cpu = {NULL, free_buffers, take, pull, NULL};
  tn_begin(&node, &config, &port, &cpu);
}

static void read_line(void) {
  while (!(UART_FLAGS & RX_EMPTY)) {
    if (!tn_read_frame(&reader, (uint8_t)UART_DATA)) continue;
    if (reader.place == TN_PLACE_BOOT && reader.size == 8 && boot == 0) {
      boot = tn_get64(reader.bytes + 2);
      begin();
    } else if (boot != 0 && reader.place != TN_PLACE_BOOT) {
      tn_came(&node, reader.place, reader.bytes + 2, reader.size);
    }
  }
}

int main(void) {
  start_board();
  uint32_t asked = 0;
  for (;;) {
    read_line();
    if (!cpu_hangs) run_cpu();
    send_bark();
    if (boot != 0) {
      tn_passed(&node);
    } else if (milliseconds - asked >= ASK_EVERY) {
      asked = milliseconds;
      tn_write_frame(TN_PLACE_BOOT, NULL, 0, put_byte, NULL);
    }
    sleep();
    if (reset_wanted) RESET_CONTROL = 0x05FA0004; /* behind the packet that asked for it, which has been passed on */
  }
}
