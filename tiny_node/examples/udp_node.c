/* A node of its own on Linux, over UDP: the port is 40 lines. Its CPU sends each packet of channel 0 back to its
   source, as examples/echo_cpu.cpp does, and pins 0 to 2 are wired to a line of text.

   tiny_node_udp RING NODE PORT IDS [AGREEMENT]
     RING       the ring's name
     NODE       id of this node; it listens at 127.0.0.1, at PORT + NODE
     IDS        the ids of all nodes in ring order, with commas between them: 0,1,2
     AGREEMENT  112 hexadecimal digits (protocol.md section 6.13); default: of a plain ring, whose nodes are node0, ...
 */
#define _POSIX_C_SOURCE 200809L
#include <arpa/inet.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "tiny_node.h"

enum { TURN = 1 /* ms */, FREE_BUFFERS = 32, NAME = 12, BACK = 1 /* priority */ };

typedef struct {
  int socket;
  uint16_t port;
  tn_node node;
} udp_node;

static volatile sig_atomic_t over;
static void end(int signal_number) {
  (void)signal_number;
  over = 1;
}

/* ---- the port ---- */

/* Strangers' addresses are 4 bytes and a port, above those of nodes. */
static bool send_datagram(void* context, tn_address to, const uint8_t* bytes, size_t size) {
  const udp_node* udp = context;
  struct sockaddr_in address = {.sin_family = AF_INET};
  address.sin_addr.s_addr = htonl(to < TN_NODE_ADDRESSES ? INADDR_LOOPBACK : (uint32_t)(to >> 16));
  address.sin_port = htons((uint16_t)(to < TN_NODE_ADDRESSES ? udp->port + to : to));
  return sendto(udp->socket, bytes, size, 0, (const struct sockaddr*)&address, sizeof address) == (ssize_t)size;
}

static uint32_t milliseconds(void* context) {
  (void)context;
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (uint32_t)((uint64_t)now.tv_sec * 1000u + (uint64_t)now.tv_nsec / 1000000u);
}

static void read_datagrams(udp_node* udp) {
  uint8_t bytes[2048];
  struct sockaddr_in from;
  socklen_t length = sizeof from;
  ssize_t size;
  while ((size = recvfrom(udp->socket, bytes, sizeof bytes, MSG_DONTWAIT, (struct sockaddr*)&from, &length)) >= 0) {
    tn_came(&udp->node, (uint64_t)ntohl(from.sin_addr.s_addr) << 16 | ntohs(from.sin_port), bytes, (size_t)size);
    length = sizeof from;
  }
}

/* ---- the CPU ---- */

static unsigned free_buffers(void* context, uint8_t priority) {
  (void)context, (void)priority;
  return FREE_BUFFERS;
}

static void take(void* context, uint8_t source, uint8_t priority, uint8_t channel, const uint8_t* data, size_t size) {
  (void)priority;
  udp_node* udp = context;
  if (channel == 0 && tn_send(&udp->node, source, BACK, 0, data, size) == 0)
    fprintf(stderr, "tiny_node_udp: no room to send a packet back to node %u\n", source);
}

static bool pull(void* context, uint8_t factor, uint8_t source) {
  (void)context;
  if (factor > 2) return false;
  printf("node %u has pulled pin %u\n", source, factor);
  fflush(stdout);
  return true;
}

/* ---- the command line ---- */

static int wrong(const char* what) {
  fprintf(stderr,
          "tiny_node_udp: %s\nusage: tiny_node_udp RING NODE PORT IDS [AGREEMENT], such as: my_ring 1 17000 0,1,2\n",
          what);
  return 2;
}

static bool read_number(const char* text, long most, long* number) {
  char* end_of_it;
  *number = strtol(text, &end_of_it, 10);
  return *text != '\0' && *end_of_it == '\0' && *number >= 0 && *number <= most;
}

static bool read_ids(tn_config* config, char* text, char names[][NAME]) {
  for (char* id = strtok(text, ","); id != NULL; id = strtok(NULL, ",")) {
    long number;
    if (!read_number(id, 254, &number) || config->count == TN_NODES) return false;
    snprintf(names[config->count], NAME, "node%u", (uint8_t)number);
    config->order[config->count++] = (uint8_t)number;
  }
  return config->count >= 2;
}

static bool read_agreement(tn_config* config, const char* digits) {
  if (strlen(digits) != 2 * TN_AGREEMENT || strspn(digits, "0123456789abcdefABCDEF") != 2 * TN_AGREEMENT) return false;
  for (size_t i = 0; i < TN_AGREEMENT; i++) {
    const char byte[3] = {digits[2 * i], digits[2 * i + 1], '\0'};
    config->agreement[i] = (uint8_t)strtoul(byte, NULL, 16);
  }
  return true;
}

static int listen_at(uint16_t port) {
  const int result = socket(AF_INET, SOCK_DGRAM, 0);
  struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons(port)};
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (result < 0 || bind(result, (const struct sockaddr*)&address, sizeof address) != 0) return -1;
  return result;
}

int main(int argc, char** argv) {
  static udp_node udp;
  static char names[TN_NODES][NAME];
  tn_config config = {.ring = argc > 1 ? argv[1] : "", .times = tn_default_times};
  long id = 0, port = 0;
  if (argc < 5 || argc > 6) return wrong("4 or 5 arguments are needed");
  if (!read_number(argv[2], 254, &id)) return wrong("NODE is 0 to 254");
  if (!read_number(argv[3], 65281, &port) || port < 1024) return wrong("PORT is 1024 to 65281");
  if (!read_ids(&config, argv[4], names))
    return wrong("IDS are 2 to 16 numbers from 0 to 254, with commas between them");
  config.id = (uint8_t)id;
  if (memchr(config.order, config.id, config.count) == NULL) return wrong("NODE is not among IDS");
  const char* const pointers[TN_NODES] = {names[0],  names[1],  names[2],  names[3], names[4],  names[5],
                                          names[6],  names[7],  names[8],  names[9], names[10], names[11],
                                          names[12], names[13], names[14], names[15]};
  tn_plain_agreement(&config, pointers);
  if (argc == 6 && !read_agreement(&config, argv[5])) return wrong("AGREEMENT is 112 hexadecimal digits");
  if (getrandom(&config.boot, sizeof config.boot, 0) != sizeof config.boot) return wrong("no random numbers");
  config.boot >>= 1; /* this node stores nothing: 63 random bits (protocol.md section 4.8) */
  udp.port = (uint16_t)port;
  udp.socket = listen_at((uint16_t)(port + id));
  if (udp.socket < 0) return perror("tiny_node_udp: 127.0.0.1, at PORT + NODE"), 1;
  struct sigaction ends = {.sa_handler = end};
  sigaction(SIGTERM, &ends, NULL);
  sigaction(SIGINT, &ends, NULL);
  const tn_port way = {&udp, send_datagram, milliseconds};
  const tn_cpu cpu = {&udp, free_buffers, take, pull, NULL};
  tn_begin(&udp.node, &config, &way, &cpu);
  while (!over) {
    struct pollfd line = {.fd = udp.socket, .events = POLLIN};
    if (poll(&line, 1, TURN) > 0) read_datagrams(&udp);
    tn_passed(&udp.node);
  }
  close(udp.socket);
  return 0;
}
