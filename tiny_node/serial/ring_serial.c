/* Carries the UDP lines of one node over a serial port, so that a board without Ethernet is a node (src/tiny_frame.h).

   ring_serial DEVICE NODE PORT [BAUD]
     DEVICE  such as /dev/ttyACM0
     NODE    id of the node on the board; ring_serial listens at 127.0.0.1, at PORT + NODE
     PORT    links.port of the ring's file
     BAUD    default 115200; a terminal that has no rate (a pty) ignores it

   SIGUSR1 prints what was carried and lost; so does the end. */
#define _DEFAULT_SOURCE
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "tiny_frame.h"

enum { STRANGERS = 64, NODES = 256, ROOM = 1 << 16, WAIT = 1000 /* ms */ };

typedef struct {
  int device, socket;
  uint16_t port;
  struct sockaddr_in strangers[STRANGERS]; /* where datagrams came from that no node listens at */
  unsigned known, next;
  tn_frame_reader reader;
  uint8_t waiting[ROOM]; /* for the device */
  size_t wait_size;
  unsigned long to_board, from_board, no_room, no_place, unsent;
} bridge;

static volatile sig_atomic_t over, asked;

static void on_signal(int number) {
  if (number == SIGUSR1)
    asked = 1;
  else
    over = 1;
}

static void print_counts(const bridge* b) {
  fprintf(stderr,
          "ring_serial: %lu datagrams to the board, %lu from it; damaged frames %lu, no room on the line %lu, "
          "to nobody %lu, not sent %lu\n",
          b->to_board, b->from_board, (unsigned long)b->reader.damaged, b->no_room, b->no_place, b->unsent);
}

/* ---- to the board ---- */

static void put(void* context, uint8_t byte) {
  bridge* b = context;
  b->waiting[b->wait_size++] = byte;
}

static void frame(bridge* b, uint16_t place, const uint8_t* bytes, size_t size) {
  if (size > TN_MOST_DATAGRAM || b->wait_size + TN_MOST_FRAME > ROOM) {
    b->no_room++;
    return;
  }
  tn_write_frame(place, bytes, size, put, b);
  b->to_board++;
}

static bool same(const struct sockaddr_in* a, const struct sockaddr_in* b) {
  return a->sin_port == b->sin_port && a->sin_addr.s_addr == b->sin_addr.s_addr;
}

/* The oldest of too many strangers is forgotten. */
static uint16_t place_of(bridge* b, const struct sockaddr_in* from) {
  for (unsigned i = 0; i < b->known; i++)
    if (same(&b->strangers[i], from)) return (uint16_t)(NODES + i);
  const unsigned at = b->known < STRANGERS ? b->known++ : b->next++ % STRANGERS;
  b->strangers[at] = *from;
  return (uint16_t)(NODES + at);
}

static void read_socket(bridge* b) {
  uint8_t bytes[2048];
  struct sockaddr_in from;
  socklen_t length = sizeof from;
  ssize_t size;
  while ((size = recvfrom(b->socket, bytes, sizeof bytes, MSG_DONTWAIT, (struct sockaddr*)&from, &length)) >= 0) {
    frame(b, place_of(b, &from), bytes, (size_t)size);
    length = sizeof from;
  }
}

static bool write_device(bridge* b) {
  const ssize_t written = write(b->device, b->waiting, b->wait_size);
  if (written < 0) return errno == EAGAIN || errno == EINTR;
  b->wait_size -= (size_t)written;
  memmove(b->waiting, b->waiting + written, b->wait_size);
  return true;
}

/* ---- from the board ---- */

static void give_boot(bridge* b) {
  uint8_t number[8];
  if (getrandom(number, sizeof number, 0) != sizeof number) return;
  number[0] &= 0x7F; /* 63 random bits (protocol.md section 4.8) */
  frame(b, TN_PLACE_BOOT, number, sizeof number);
}

static void hand_on(bridge* b) {
  const uint16_t place = b->reader.place;
  struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)(b->port + place))};
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  b->from_board++;
  if (place == TN_PLACE_BOOT) {
    give_boot(b);
    return;
  }
  if (place >= NODES + b->known) {
    b->no_place++;
    return;
  }
  if (place >= NODES) to = b->strangers[place - NODES];
  if (sendto(b->socket, b->reader.bytes + 2, b->reader.size, 0, (const struct sockaddr*)&to, sizeof to) < 0)
    b->unsent++;
}

static bool read_device(bridge* b) {
  uint8_t bytes[4096];
  const ssize_t size = read(b->device, bytes, sizeof bytes);
  if (size <= 0) return size < 0 && (errno == EAGAIN || errno == EINTR);
  for (ssize_t i = 0; i < size; i++)
    if (tn_read_frame(&b->reader, bytes[i])) hand_on(b);
  return true;
}

/* ---- start ---- */

static int wrong(const char* what) {
  fprintf(stderr, "ring_serial: %s\nusage: ring_serial DEVICE NODE PORT [BAUD], such as: /dev/ttyACM0 3 17000 921600\n",
          what);
  return 2;
}

static bool read_number(const char* text, long most, long* number) {
  char* end;
  *number = strtol(text, &end, 10);
  return *text != '\0' && *end == '\0' && *number >= 0 && *number <= most;
}

static bool baud_of(long number, speed_t* speed) {
  static const struct {
    long number;
    speed_t speed;
  } kKnown[] = {{9600, B9600},     {57600, B57600},     {115200, B115200},   {230400, B230400},  {460800, B460800},
                {921600, B921600}, {1000000, B1000000}, {2000000, B2000000}, {3000000, B3000000}};
  for (size_t i = 0; i < sizeof kKnown / sizeof *kKnown; i++)
    if (kKnown[i].number == number) return *speed = kKnown[i].speed, true;
  return false;
}

static int open_device(const char* path, speed_t speed) {
  const int device = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK);
  struct termios mode;
  if (device < 0 || tcgetattr(device, &mode) != 0) return -1;
  cfmakeraw(&mode);
  mode.c_cflag |= CLOCAL | CREAD;
  cfsetspeed(&mode, speed);
  if (tcsetattr(device, TCSANOW, &mode) != 0) return -1;
  tcflush(device, TCIOFLUSH);
  return device;
}

static int listen_at(uint16_t port) {
  const int result = socket(AF_INET, SOCK_DGRAM, 0);
  struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons(port)};
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (result < 0 || bind(result, (const struct sockaddr*)&address, sizeof address) != 0) return -1;
  return result;
}

static int run(bridge* b) {
  while (!over) {
    struct pollfd ends[2] = {{.fd = b->device, .events = (short)(POLLIN | (b->wait_size > 0 ? POLLOUT : 0))},
                             {.fd = b->socket, .events = POLLIN}};
    if (asked) print_counts(b), asked = 0;
    if (poll(ends, 2, WAIT) <= 0) continue;
    if (ends[1].revents != 0) read_socket(b);
    const bool gone =
        ((ends[0].revents & (POLLIN | POLLHUP | POLLERR)) && !read_device(b)) || (b->wait_size > 0 && !write_device(b));
    if (gone) {
      fprintf(stderr, "ring_serial: the device is gone: %s\n", strerror(errno));
      print_counts(b);
      return 1;
    }
  }
  print_counts(b);
  return 0;
}

int main(int argc, char** argv) {
  static bridge b;
  long node = 0, port = 0, baud = 115200;
  speed_t speed = B115200;
  if (argc < 4 || argc > 5) return wrong("3 or 4 arguments are needed");
  if (!read_number(argv[2], 254, &node)) return wrong("NODE is 0 to 254");
  if (!read_number(argv[3], 65281, &port) || port < 1024) return wrong("PORT is 1024 to 65281");
  if (argc == 5 && (!read_number(argv[4], 3000000, &baud) || !baud_of(baud, &speed)))
    return wrong("BAUD is 9600, 57600, 115200, 230400, 460800, 921600, 1000000, 2000000 or 3000000");
  b.port = (uint16_t)port;
  b.device = open_device(argv[1], speed);
  if (b.device < 0) return fprintf(stderr, "ring_serial: %s: %s\n", argv[1], strerror(errno)), 1;
  b.socket = listen_at((uint16_t)(port + node));
  if (b.socket < 0)
    return fprintf(stderr, "ring_serial: 127.0.0.1, UDP port %ld: %s\n", port + node, strerror(errno)), 1;
  struct sigaction act = {.sa_handler = on_signal};
  sigaction(SIGTERM, &act, NULL);
  sigaction(SIGINT, &act, NULL);
  sigaction(SIGUSR1, &act, NULL);
  return run(&b);
}
