/* The node as a shared library, for `ringctl conform --library`: three functions, which the kit calls with a time of
   its own. Its CPU sends each packet of channel 0 back to its source. */
#include <string.h>

#include "tiny_node.h"

enum { FREE_BUFFERS = 32 };

typedef void (*library_send)(uint32_t to, const uint8_t* bytes, size_t size);

static tn_node node;
static uint32_t time_now;
static library_send sending;

static bool send_datagram(void* context, tn_address to, const uint8_t* bytes, size_t size) {
  (void)context;
  sending((uint32_t)to, bytes, size);
  return true;
}

static uint32_t milliseconds(void* context) {
  (void)context;
  return time_now;
}

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
  return factor <= 2;
}

/* A node that starts.
   @param order the ids in ring order
   @param agreement TN_AGREEMENT bytes
   @param now ms
   @param send is called with each datagram and whom it goes to: an id, or what library_node_came said */
void library_node_begin(const char* ring, uint8_t id, const uint8_t* order, uint8_t count, const uint8_t* agreement,
                        uint64_t boot, uint32_t now, library_send send);
void library_node_came(uint32_t now, uint32_t from, const uint8_t* bytes, size_t size);
void library_node_passed(uint32_t now);

void library_node_begin(const char* ring, uint8_t id, const uint8_t* order, uint8_t count, const uint8_t* agreement,
                        uint64_t boot, uint32_t now, library_send send) {
  tn_config config = {.ring = ring, .id = id, .count = count, .boot = boot, .times = tn_default_times};
  memcpy(config.order, order, count);
  memcpy(config.agreement, agreement, TN_AGREEMENT);
  const tn_port port = {NULL, send_datagram, milliseconds};
  const tn_cpu cpu = {NULL, free_buffers, take, pull, NULL};
  time_now = now;
  sending = send;
  tn_begin(&node, &config, &port, &cpu);
}

void library_node_came(uint32_t now, uint32_t from, const uint8_t* bytes, size_t size) {
  time_now = now;
  tn_came(&node, from, bytes, size);
}

void library_node_passed(uint32_t now) {
  time_now = now;
  tn_passed(&node);
}
