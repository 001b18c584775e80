/* Datagrams over a serial line (ours): each is a frame of COBS, so 0x00 only ends frames, and a reader that has lost
   its place finds the next one. Before COBS: place (2 bytes), datagram, CRC-32 of both (4 bytes); big-endian.

   To the board the place is where the datagram comes from, from the board where it goes to: below 256 the receiving end
   of the node with that id, at 256 and above what ring_serial has made up for another address. At TN_PLACE_BOOT the
   board asks by an empty datagram for a boot number, and gets 8 bytes. */
#ifndef TINY_FRAME_H
#define TINY_FRAME_H

#include "tiny_wire.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  TN_PLACE_BOOT = 0xFFFF,
  TN_MOST_FRAMED = 2 + TN_MOST_DATAGRAM + 4,
  TN_MOST_FRAME = TN_MOST_FRAMED + TN_MOST_FRAMED / 254 + 2 /* bytes on the line */
};

/* Gives the bytes of a frame to put(), one after another; up to TN_MOST_FRAME. */
void tn_write_frame(uint16_t place, const uint8_t* datagram, size_t size, void (*put)(void* context, uint8_t byte),
                    void* context);

typedef struct {
  uint8_t bytes[TN_MOST_FRAMED];
  uint16_t size; /* of the datagram, which begins at bytes + 2 */
  uint16_t place;
  uint16_t have;
  uint8_t left, code;
  bool wrong;
  uint32_t frames, damaged; /* how many were right, and how many not */
} tn_frame_reader;

/* One byte of the line. @return whether a frame is whole and right: place, size and bytes + 2 hold until the next call
 */
bool tn_read_frame(tn_frame_reader* reader, uint8_t byte);

#ifdef __cplusplus
}
#endif
#endif
