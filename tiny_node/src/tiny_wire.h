/* Bytes on a line: CRC, hashes, link headers. (protocol.md sections 3, 6.2 and 6.5) */
#ifndef TINY_WIRE_H
#define TINY_WIRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
  TN_MOST_DATA = 512,     /* bytes of data in a DATP */
  TN_MOST_PACKET = 524,   /* bytes of a DATP */
  TN_INTERRUPT_SIZE = 12, /* bytes of an INTP */
  TN_HEADER = 26,         /* bytes of a link header */
  TN_AGREEMENT = 56,      /* bytes behind a connect (protocol.md section 6.13) */
  TN_SLICE = 4,           /* bytes before those of a slice */
  TN_MOST_DATAGRAM = TN_HEADER + TN_SLICE + TN_MOST_PACKET,
  TN_ALL = 0xFF,
  TN_UNTAKEN = 0xFF /* FBC: nobody has taken it */
};

enum { TN_START = 1, TN_MORE, TN_END, TN_WHOLE, TN_INTERRUPT, TN_ABORT, TN_IDLE, TN_FOLD };
enum { TN_CONNECT = 1, TN_ACCEPT, TN_REFUSE, TN_SLICES, TN_ALIVE, TN_BYE };
enum {
  TN_NO_REFUSAL = 0,
  TN_BUSY,
  TN_REPLACED,
  TN_WRONG_RING,
  TN_NOT_IN_RING,
  TN_UNKNOWN_SESSION,
  TN_CLOSING,
  TN_WRONG_VERSION,
  TN_OTHER_RING_FILE = 9,
  TN_LAST_REFUSAL = 12
};

typedef struct {
  uint8_t version, type, sender, refusal;
  uint64_t ring, session;
  uint32_t sequence;
} tn_header;

uint32_t tn_get32(const uint8_t* bytes);
void tn_put32(uint8_t* bytes, uint32_t value);
uint64_t tn_get64(const uint8_t* bytes);
void tn_put64(uint8_t* bytes, uint64_t value);

/* CRC-32 of IEEE 802.3. (protocol.md section 3.7) */
uint32_t tn_crc(const uint8_t* bytes, size_t size);

/* The same in parts: begin, more for each part, end. */
uint32_t tn_crc_begin(void);
uint32_t tn_crc_more(uint32_t so_far, const uint8_t* bytes, size_t size);
uint32_t tn_crc_end(uint32_t so_far);

/* What XORing delta into a byte with `after` more bytes behind it does to the CRC. (protocol.md section 3.7) */
uint32_t tn_change(uint8_t delta, size_t after);

/* Writes HOP and FBC into a packet by the patch rule: a wrong CRC stays wrong. (protocol.md section 3.7) */
void tn_patch(uint8_t* packet, size_t size, uint8_t hop, uint8_t fbc);

/* The CRC that this packet had as its source sent it, if its CRC is right. (protocol.md section 4.2) */
uint32_t tn_crc_as_sent(const uint8_t* packet, size_t size);

/* FNV-1a, 64 bits, of one more text; begin with TN_FNV. (protocol.md section 6.5) */
#define TN_FNV 0xCBF29CE484222325u
uint64_t tn_hash(uint64_t so_far, const char* text);

/* The 26 bytes of a link header. (protocol.md section 6.5) */
void tn_write_header(uint8_t* bytes, const tn_header* header);

/* False if these bytes are not a link header. In another version, only a connect and its refusal are accepted. */
bool tn_read_header(const uint8_t* bytes, size_t size, tn_header* header);

/* Whether a slice of that kind may have that many bytes. (protocol.md section 6.2) */
bool tn_slice_fits(uint8_t kind, size_t size);

#ifdef __cplusplus
}
#endif
#endif
