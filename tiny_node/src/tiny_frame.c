#include "tiny_frame.h"

enum { LONGEST_RUN = 254 };

typedef struct {
  uint8_t head[2], tail[4];
  const uint8_t* datagram;
  size_t size;
} parts;

static uint8_t byte_at(const parts* all, size_t i) {
  if (i < 2) return all->head[i];
  return i < 2 + all->size ? all->datagram[i - 2] : all->tail[i - 2 - all->size];
}

static uint32_t crc_of(const parts* all) {
  uint32_t crc = tn_crc_begin();
  crc = tn_crc_more(crc, all->head, sizeof all->head);
  return tn_crc_end(tn_crc_more(crc, all->datagram, all->size));
}

void tn_write_frame(uint16_t place, const uint8_t* datagram, size_t size, void (*put)(void* context, uint8_t byte),
                    void* context) {
  parts all = {{(uint8_t)(place >> 8), (uint8_t)place}, {0}, datagram, size};
  tn_put32(all.tail, crc_of(&all));
  const size_t end = size + 6;
  for (size_t i = 0; i <= end;) {
    size_t run = 0;
    while (i + run < end && run < LONGEST_RUN && byte_at(&all, i + run) != 0) run++;
    put(context, (uint8_t)(run + 1));
    for (size_t k = 0; k < run; k++) put(context, byte_at(&all, i + k));
    i += run + (run < LONGEST_RUN ? 1 : 0); /* the zero is in the code, or it is the end */
    if (run == LONGEST_RUN && i == end) break;
  }
  put(context, 0);
}

static void keep(tn_frame_reader* reader, uint8_t byte) {
  if (reader->have == TN_MOST_FRAMED)
    reader->wrong = true;
  else
    reader->bytes[reader->have++] = byte;
}

/* The end of a frame. */
static bool whole(tn_frame_reader* reader) {
  const uint16_t have = reader->have;
  const bool empty = have == 0 && reader->code == 0;
  const bool right = !reader->wrong && reader->left == 0 && have >= 6 &&
                     tn_crc(reader->bytes, have - 4u) == tn_get32(reader->bytes + have - 4);
  reader->have = 0;
  reader->left = reader->code = 0;
  reader->wrong = false;
  if (right) {
    reader->frames++;
    reader->place = (uint16_t)(reader->bytes[0] << 8 | reader->bytes[1]);
    reader->size = (uint16_t)(have - 6);
  } else if (!empty) {
    reader->damaged++;
  }
  return right;
}

bool tn_read_frame(tn_frame_reader* reader, uint8_t byte) {
  if (byte == 0) return whole(reader);
  if (reader->left > 0) {
    reader->left--;
    keep(reader, byte);
    return false;
  }
  if (reader->code != 0 && reader->code != LONGEST_RUN + 1) keep(reader, 0);
  reader->code = byte;
  reader->left = (uint8_t)(byte - 1);
  return false;
}
