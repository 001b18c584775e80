#include "tiny_wire.h"

enum { MAGIC_0 = 0x4C, MAGIC_1 = 0x52, VERSION = 3, LAST_TYPE = 8 };

uint32_t tn_get32(const uint8_t* bytes) {
  return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

void tn_put32(uint8_t* bytes, uint32_t value) {
  for (int i = 0; i < 4; i++) bytes[i] = (uint8_t)(value >> (24 - 8 * i));
}

uint64_t tn_get64(const uint8_t* bytes) { return (uint64_t)tn_get32(bytes) << 32 | tn_get32(bytes + 4); }

void tn_put64(uint8_t* bytes, uint64_t value) {
  tn_put32(bytes, (uint32_t)(value >> 32));
  tn_put32(bytes + 4, (uint32_t)value);
}

/* One byte through the CRC, by two steps of 4 bits: a table of 64 bytes. */
static uint32_t crc_step(uint32_t r) {
  static const uint32_t kTable[16] = {0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC, 0x76DC4190, 0x6B6B51F4,
                                      0x4DB26158, 0x5005713C, 0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C,
                                      0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C};
  r = r >> 4 ^ kTable[r & 15];
  return r >> 4 ^ kTable[r & 15];
}

uint32_t tn_crc_begin(void) { return 0xFFFFFFFFu; }

uint32_t tn_crc_more(uint32_t so_far, const uint8_t* bytes, size_t size) {
  for (size_t i = 0; i < size; i++) so_far = crc_step(so_far ^ bytes[i]);
  return so_far;
}

uint32_t tn_crc_end(uint32_t so_far) { return ~so_far; }

uint32_t tn_crc(const uint8_t* bytes, size_t size) { return tn_crc_end(tn_crc_more(tn_crc_begin(), bytes, size)); }

uint32_t tn_change(uint8_t delta, size_t after) {
  uint32_t r = delta;
  if (r == 0) return 0;
  for (size_t i = 0; i <= after; i++) r = crc_step(r);
  return r;
}

static uint32_t patched_crc(const uint8_t* packet, size_t size, uint8_t hop, uint8_t fbc) {
  return tn_get32(packet + size - 4) ^ tn_change(packet[2] ^ hop, size - 7) ^ tn_change(packet[size - 7] ^ fbc, 2);
}

void tn_patch(uint8_t* packet, size_t size, uint8_t hop, uint8_t fbc) {
  tn_put32(packet + size - 4, patched_crc(packet, size, hop, fbc));
  packet[2] = hop;
  packet[size - 7] = fbc;
}

uint32_t tn_crc_as_sent(const uint8_t* packet, size_t size) { return patched_crc(packet, size, 0, TN_UNTAKEN); }

uint64_t tn_hash(uint64_t so_far, const char* text) {
  for (; *text != '\0'; text++) so_far = (so_far ^ (uint8_t)*text) * 0x100000001B3u;
  return so_far;
}

void tn_write_header(uint8_t* bytes, const tn_header* header) {
  bytes[0] = MAGIC_0;
  bytes[1] = MAGIC_1;
  bytes[2] = VERSION;
  bytes[3] = header->type;
  tn_put64(bytes + 4, header->ring);
  tn_put64(bytes + 12, header->session);
  tn_put32(bytes + 20, header->sequence);
  bytes[24] = header->sender;
  bytes[25] = header->refusal;
}

bool tn_read_header(const uint8_t* bytes, size_t size, tn_header* header) {
  if (size < TN_HEADER || bytes[0] != MAGIC_0 || bytes[1] != MAGIC_1) return false;
  header->version = bytes[2];
  header->type = bytes[3];
  header->ring = tn_get64(bytes + 4);
  header->session = tn_get64(bytes + 12);
  header->sequence = tn_get32(bytes + 20);
  header->sender = bytes[24];
  header->refusal = bytes[25];
  if (header->type == 0 || header->type > LAST_TYPE || header->refusal > TN_LAST_REFUSAL) return false;
  return header->version == VERSION || header->type == TN_CONNECT || header->type > TN_BYE ||
         (header->type == TN_REFUSE && header->refusal == TN_WRONG_VERSION);
}

bool tn_slice_fits(uint8_t kind, size_t size) {
  switch (kind) {
    case TN_START:
      return size >= 4 && size <= 516 && size % 4 == 0;
    case TN_MORE:
      return size >= 4 && size <= 512 && size % 4 == 0;
    case TN_END:
      return size >= 8 && size <= 520;
    case TN_WHOLE:
      return size >= 13 && size <= TN_MOST_PACKET;
    case TN_INTERRUPT:
      return size == TN_INTERRUPT_SIZE;
    case TN_ABORT:
    case TN_IDLE:
      return size == 0;
    case TN_FOLD:
      return size == 3;
    default:
      return false;
  }
}
