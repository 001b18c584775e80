/* The node on a Cortex-M3, over its UART: Stellaris LM3S6965, as QEMU has it (-machine lm3s6965evb). Built with the
   ring in BOARD_RING, this node in BOARD_NODE and the number of nodes, whose ids are 0, 1, ... and names node0, node1,
   ..., in BOARD_NODES. It stores nothing, so it asks the other end for a boot number. Pin 0 resets the board. */
#include "tiny_frame.h"
#include "tiny_node.h"

#ifndef BOARD_RING
#define BOARD_RING "board"
#define BOARD_NODE 1
#define BOARD_NODES 3
#endif

enum {
  FREE_BUFFERS = 4,
  ASK_EVERY = 100 /* ms */,
  TICKS = 12500 /* of 12.5 MHz: 1 ms */,
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
#define CLOCK_UARTS REGISTER(0x400FE104)
#define CLOCK_PORTS REGISTER(0x400FE108)
#define PORT_A_FUNCTION REGISTER(0x40004420)
#define PORT_A_DIGITAL REGISTER(0x4000451C)
#define SYSTICK_CONTROL REGISTER(0xE000E010)
#define SYSTICK_RELOAD REGISTER(0xE000E014)
#define RESET_CONTROL REGISTER(0xE000ED0C)

static tn_node node;
static tn_frame_reader reader;
static volatile uint32_t milliseconds;
static uint64_t boot;
static bool reset_wanted;

/* ---- the board ---- */

void systick(void);
void systick(void) { milliseconds++; }

static void start_board(void) {
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

/* ---- the CPU: sends each packet of channel 0 back ---- */

static unsigned free_buffers(void* context, uint8_t priority) {
  (void)context, (void)priority;
  return FREE_BUFFERS;
}

static void take(void* context, uint8_t source, uint8_t priority, uint8_t channel, const uint8_t* data, size_t size) {
  (void)context;
  if (channel == 0) tn_send(&node, source, priority, channel, data, size);
}

static bool pull(void* context, uint8_t factor, uint8_t source) {
  (void)context, (void)source;
  if (factor == 0) reset_wanted = true;
  return factor <= 2;
}

static void begin(void) {
  static const char* const kNames[] = {"node0", "node1", "node2",  "node3",  "node4",  "node5",  "node6",  "node7",
                                       "node8", "node9", "node10", "node11", "node12", "node13", "node14", "node15"};
  static tn_config config;
  config.ring = BOARD_RING;
  config.id = BOARD_NODE;
  config.count = BOARD_NODES;
  for (uint8_t i = 0; i < BOARD_NODES; i++) config.order[i] = i;
  config.times = tn_default_times;
  config.boot = boot;
  tn_plain_agreement(&config, kNames);
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
    if (boot != 0) {
      tn_passed(&node);
    } else if (milliseconds - asked >= ASK_EVERY) {
      asked = milliseconds;
      tn_write_frame(TN_PLACE_BOOT, NULL, 0, put_byte, NULL);
    }
    if (reset_wanted) RESET_CONTROL = 0x05FA0004; /* behind the packet that asked for it, which has been passed on */
  }
}
