/* The two ends of a UDP line; within tiny_node. (protocol.md sections 6.5 to 6.10) */
#ifndef TINY_LINK_H
#define TINY_LINK_H

#include "tiny_node.h"

void tn_link_begin(tn_node* node);

/* Reads a datagram of the line; its slices go to tn_slice. */
void tn_link_came(tn_node* node, tn_address from, const uint8_t* bytes, size_t size);

/* Does what is due by time: ticks, and attempts to reach the next candidates. */
void tn_link_passed(tn_node* node, uint32_t now);

/* One slice onto the line; false if the line is down. */
bool tn_link_write(tn_node* node, uint8_t kind, const uint8_t* bytes, size_t size);

/* The candidate of the output that a node is: 0 is the successor, count - 1 the node itself; count if it is not in the
 * ring. */
uint8_t tn_place(const tn_node* node, uint8_t id);

/* ---- What the node is told ---- */

void tn_slice(tn_node* node, uint8_t kind, const uint8_t* bytes, size_t size);
void tn_gap(tn_node* node);
void tn_input_came(tn_node* node, bool replaced);
void tn_input_lost(tn_node* node);
void tn_output_came(tn_node* node, bool replaced);
void tn_output_lost(tn_node* node);

#endif
