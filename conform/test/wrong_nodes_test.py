"""Nodes that are wrong on purpose: the node in C (tiny_node), each with one text of its sources changed. Each is failed by
the cases about it, and by no other.

usage: wrong_nodes_test.py [--table] [--only KIND] [--compiler cc]     exit code 0: each kind was failed as said here"""

import argparse
import collections
import concurrent.futures
import json
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
SOURCES = os.path.join(ROOT, 'tiny_node', 'src')
FILES = ('tiny_wire.c', 'tiny_link.c', 'tiny_node.c', os.path.join('..', 'examples', 'library_node.c'))
WORKERS = 2

# `cases`: the cases that fail it, and are about it.
Kind = collections.namedtuple('Kind', 'name file text instead cases')
WIRE, LINK, NODE = FILES[:3]
KINDS = [
    # ---- Relay
    Kind('HOP is not incremented', NODE, '(uint8_t)(packet[2] + 1), fbc);', '(uint8_t)(packet[2]), fbc);', '2.2-1 2.2-2'),
    Kind('HOP goes up by two', NODE, '(uint8_t)(packet[2] + 1), fbc);', '(uint8_t)(packet[2] + 2), fbc);', '2.2-1 2.2-2'),
    Kind('the CRC is computed anew', NODE, '  tn_patch(packet, size, (uint8_t)(packet[2] + 1), fbc);',
         '  packet[2]++; packet[size - 7] = fbc; tn_put32(packet + size - 4, tn_crc(packet, size - 4));', '3.7-1 3.7-2'),
    Kind('the CRC is not patched', NODE, '  tn_patch(packet, size, (uint8_t)(packet[2] + 1), fbc);',
         '  packet[2]++; packet[size - 7] = fbc;', '2.2-3 2.2-4 3.7-1 3.7-2'),
    Kind('FBC is not written', NODE, 'interrupt) : packet[size - 7];', 'interrupt) * 0 + packet[size - 7] : packet[size - 7];', '2.3-2 2.3-6 3.2-2 3.5-1 3.5-2 3.5-7 3.5-8 3.5-9 3.8-1 3.8-2 3.9-1 3.9-2 3.9-3 4.8-8 4.8-9 4.8-10 4.10-1 4.10-2 4.10-11 4.10-12 4.10-13 4.10-14 4.10-15 4.10-16 4.10-17 4.10-18 4.10-19 4.10-21 4.10-22 4.10-23 4.10-24 4.10-25 4.10-26 4.10-27 4.10-28 4.10-29'),
    Kind('FBC is overwritten, not the least', NODE, 'return a < b ? a : (uint8_t)b;', 'return (void)a, (uint8_t)b;', '3.5-3 3.5-4'),
    Kind('own packets are not taken off the ring', NODE, '      came_home(node, packet, size, interrupt);',
         '      came_home(node, packet, size, interrupt), pass_on(node, packet, size, interrupt, packet[size - 7]);', '2.2-12 2.2-13'),
    Kind('own damaged packets are not taken off the ring', NODE, '      damaged_return(node, interrupt);\n    return;',
         '      damaged_return(node, interrupt), pass_on(node, packet, size, interrupt, 255);\n    return;', '2.2-14'),
    Kind('packets circle for ever', NODE, 'if (packet[2] + 1 >= node->config.count) {', 'if (packet[2] == 254) {', '4.9-2 4.9-3 4.9-4 4.9-5'),
    Kind('HOP ends a packet one node early', NODE, 'if (packet[2] + 1 >= node->config.count) {',
         'if (packet[2] + 2 >= node->config.count) {', '2.2-20'),
    Kind('what HOP ends is received', NODE, '    node->counters.orphans_hop++;\n', '    receive(node, packet, size, interrupt);\n', '4.9-5'),
    Kind('SOP is not looked at', NODE, 'packet[1] != SOP || ', '', '2.2-16 2.2-17'),
    Kind('the kind bit is not looked at', NODE, '(packet[0] >> 5 & 1) != interrupt || ', '', '2.2-18 2.2-19'),
    Kind('SID 255 is a node', NODE, ' || packet[3] == TN_ALL) {', ') {', '2.2-15'),
    Kind('damaged packets are dropped', NODE, '  if (!right)\n    node->counters.crc_errors++;', '  if (!right)\n    return;', '2.3-3 2.3-4 3.7-1 3.7-2 4.3-10'),
    Kind('orphans of bypassed nodes go on', NODE, 'node->output.up && tn_place(node, packet[3]) < node->output.at', '0', '4.9-1'),
    # ---- slices
    Kind('data of 512 bytes are too long', NODE, 'TN_MOST_PACKET : TN_MOST_PACKET - 8)', 'TN_MOST_PACKET - 1 : TN_MOST_PACKET - 8)', '6.3-6'),
    Kind('`more` is not known', NODE, 'kind == TN_MORE || kind == TN_END || kind == TN_ABORT', 'kind == TN_END || kind == TN_ABORT', '6.3-4 6.3-5 6.3-6'),
    Kind('an INTP ends the DATP around it', NODE, '    uint8_t packet[TN_INTERRUPT_SIZE];', '    uint8_t packet[TN_INTERRUPT_SIZE]; node->open = false;', '5.2-1 5.2-2 5.2-3'),
    Kind('an INTP within a DATP is lost', NODE, '    relay(node, packet, size, true);', '    if (!node->open) relay(node, packet, size, true);', '5.2-1 5.2-2 5.2-4 5.2-6'),
    Kind('`abort` is ignored', NODE, '    break_off(node, &node->counters.aborts_received);', '    ;', '2.6-1'),
    Kind('`idle` ends a DATP', NODE, '  if (kind == TN_INTERRUPT) {\n', '  if (kind == TN_IDLE) node->open = false;\n  if (kind == TN_INTERRUPT) {\n', '6.3-10'),
    Kind('a fold word ends a DATP', NODE, '  if (kind == TN_INTERRUPT) {\n', '  if (kind == TN_FOLD) node->open = false;\n  if (kind == TN_INTERRUPT) {\n', '6.3-11'),
    Kind('a DATP is not bounded by 524 bytes', NODE, '(kind == TN_END ? TN_MOST_PACKET : TN_MOST_PACKET - 8)) {',
         '(kind == TN_END ? TN_MOST_PACKET : TN_MOST_PACKET - 8)) {\n    if (kind == TN_END) { node->open = false; relay(node, node->coming, node->come, false); }\n  } else if (node->come + size > TN_MOST_PACKET) {', '2.6-7'),
    Kind('a DATP without data goes on', NODE, 'node->come + size < LEAST_DATP', '0', '2.6-8'),
    Kind('the rest of a DATP is waited for without end', NODE, 'if (node->open && now - node->open_since >= node->config.times.stall)',
         'if (0)', '2.6-9'),
    Kind('another start does not break a DATP off', NODE, '    break_off(node, &node->counters.broken_off_packets);\n    node->come = 0;',
         '    if (node->open) return;\n    node->come = 0;', '2.6-5 2.6-6'),
    # ---- Receive
    Kind('answers for a neighbour', NODE, 'const bool addressed = destination == node->config.id ||',
         'const bool addressed = destination == 5 || destination == node->config.id ||', '2.3-9 3.5-5 3.5-6'),
    Kind('broadcasts are for others', NODE, '(destination == TN_ALL && packet[3] != node->config.id)', '0', '2.3-8 3.5-2 3.5-9 3.8-1 3.8-2 3.9-1 3.9-2 3.9-3 4.8-10 4.10-5 4.10-7 4.10-22 4.10-23 4.10-25'),
    Kind('damaged packets are answered', NODE, 'right && ends ? receive(', '1 ? receive(', '2.3-3 2.3-4 2.3-5'),
    Kind('EOP is not looked at', NODE, ', ends = packet[size - 8] == EOP;', ', ends = true;', '2.3-5'),
    Kind('a pin that is wired to nothing says that it was pulled', NODE, '    node->counters.refused_unwired++;\n    return 0;', '    return 1;', '3.5-8 4.10-12 4.10-13 4.10-14 4.10-15 4.10-24 4.10-26 4.10-28'),
    Kind('INT is read with all its bits', NODE, 'packet[7] & 7;', 'packet[7];', '3.2-2'),
    Kind('hellos are answered as data are', NODE, 'unsigned value = MOST_FREE;', 'unsigned value = 32;', '3.5-9 3.8-1 3.8-2 3.9-1 3.9-2 3.9-3 4.8-10 4.10-25'),
    Kind('while it joins it takes DATPs', NODE, '  if (!joined(node)) {\n    node->counters.refused_joining++;', '  if (0) {\n    node->counters.refused_joining++;', '4.8-8 4.10-29'),
    # ---- exactly once
    Kind('a retry is delivered again', NODE, '(retry || !is_old(node, verdict))', '(!retry && !is_old(node, verdict))', '4.10-4 4.10-10'),
    Kind('a doubled packet is delivered again', NODE, '(retry || !is_old(node, verdict))', '(retry)', '4.10-3 4.10-5 4.10-13 4.10-24 4.10-26 4.10-28'),
    Kind('verdicts never grow old', NODE, 'return verdict->old || now_of(node) - verdict->when >= node->config.times.send;', 'return (void)node, (void)verdict, false;', '4.10-9'),
    Kind('old verdicts are forgotten for retries, too', NODE, '(retry || !is_old(node, verdict))', '(!is_old(node, verdict))', '4.10-10'),
    Kind('a duplicate is answered with FBC 0', NODE, '  if (!verdict->taken)\n    return 0;', '  return 0;', '4.10-1 4.10-2 4.10-11'),
    Kind('a refused number is taken the second time', NODE, '  if (!verdict->taken)\n    return 0;', '', '4.10-12 4.10-13 4.10-24 4.10-26 4.10-28 4.10-29'),
    Kind('broadcasts and unicasts share their numbers', NODE, '&page->verdicts[interrupt][packet[size - 6] == TN_ALL];', '&page->verdicts[interrupt][0];', '4.10-7'),
    Kind('INTPs and DATPs share their numbers', NODE, '&page->verdicts[interrupt][packet[size - 6] == TN_ALL];', '&page->verdicts[0][packet[size - 6] == TN_ALL];', '4.10-14'),
    Kind('all sources share one page', NODE, 'page_of(node, packet[3], packet[0] >> 6);', 'page_of(node, 77, packet[0] >> 6);', '4.10-18 4.10-21'),
    Kind('incarnations are not looked at', NODE, '  if (ahead != 0)\n', '  if (page == NULL)\n', '4.10-16 4.10-17 4.10-28'),
    Kind('an earlier incarnation is taken', NODE, '  if (ahead == 3)\n    return NULL;', '  if (ahead == 3)\n    return page;', '4.10-18 4.10-19 4.10-20'),
    Kind('an incarnation two ahead is an earlier one', NODE, '  if (ahead == 3)\n', '  if (ahead >= 2)\n', '4.10-17'),
    Kind('a hello does not begin a new page', NODE, 'if (hello || page == NULL || page->incarnation != (boot & 3))', 'if (page == NULL || (!hello && page->incarnation != (boot & 3)))', '4.10-18 4.10-21'),
    Kind('hellos of an earlier incarnation are heeded', NODE, 'page->boot - boot <= OLD_BOOTS', 'page->boot - boot <= 0', '4.10-22 4.10-23 4.10-24'),
    Kind('a clock that was set back is never heard again', NODE, ' && page->boot - boot <= OLD_BOOTS', '', '4.10-25'),
    Kind('each beacon begins a new page', NODE, 'if (!heard || page->boot != boot)\n', 'if (true)\n', '4.10-26'),
    Kind('a beacon ends the page that a packet began', NODE, 'page->incarnation != (boot & 3))', 'page->incarnation != (boot & 3) || page->by_packet)', '4.10-28'),
    Kind('unknown retries are taken while it joins', NODE, 'if (retry && !node->aware && !known) {', 'if (0) {', '4.10-30 4.10-31'),
    # ---- Transmit
    Kind('no hello', NODE, '  node->control[0] = HELLO;', '  node->control[0] = 3;', '4.7-2 4.8-1 4.8-3 4.8-4 4.8-11 4.8-12 4.8-13 8.4-1'),
    Kind('retries have the try bits of the first', NODE, '  out->code = (uint8_t)(out->code + ONE_TRY);', '', '2.6-10 4.2-1 4.2-2 4.2-3 4.2-4 4.3-2 4.3-3 4.3-4 4.3-9 4.3-11 4.8-4'),
    Kind('retries have new numbers', NODE, '  out->code = (uint8_t)(out->code + ONE_TRY);', '  out->code = (uint8_t)((out->code + ONE_TRY) ^ 1);', '2.6-10 4.2-1 4.2-2 4.2-3 4.2-4 4.3-2 4.3-3 4.3-4 4.3-9 4.3-12'),
    Kind('sequence numbers are used again', NODE, 'number->next = (number->next + 1) & 7;', 'number->next = (number->next + 0) & 7;', '4.3-3 4.4-2 4.7-1 4.8-4'),
    Kind('numbers go up by two', NODE, 'number->next = (number->next + 1) & 7;', 'number->next = (number->next + 2) & 7;', '4.4-2 4.7-1 4.8-4'),
    Kind('numbers are counted for all destinations together', NODE, 'destination == TN_ALL ? TN_NODES : tn_place(node, destination)', 'destination == 255 ? TN_NODES : 0', '4.7-8'),
    Kind('no retries', NODE, '(out->code >> 3 & 3) == TRIES', '(out->code >> 3 & 3) == 0', '2.6-10 4.2-1 4.2-2 4.2-3 4.2-4 4.3-2 4.3-3 4.3-4 4.3-9 4.3-11 4.10-33 4.10-34'),
    Kind('two retries', NODE, '(out->code >> 3 & 3) == TRIES', '(out->code >> 3 & 3) == 2', '4.3-3 4.3-11'),
    Kind('retries come too early', NODE, 'now - out->sent_at >= node->config.times.send)', 'now - out->sent_at >= node->config.times.send / 2)', '4.3-5'),
    Kind('a damaged return is a return', NODE, '    if (right && ends)\n      came_home', '    if (true)\n      came_home', '4.3-9'),
    Kind('damaged returns are ignored', NODE, '  failed(node, interrupt);\n}\n\nstatic void pass_on', '}\n\nstatic void pass_on', '4.3-10'),
    Kind('returns are not compared', NODE, 'return out->out && packet[0] ==', 'return out->out || packet[0] ==', '4.2-1 4.2-2 4.2-3 4.2-4'),
    Kind('the data of a return are not compared', NODE, ' && tn_crc_as_sent(packet, size) == out->crc;', ';', '4.2-1'),
    Kind('the try of a return is not compared', NODE, 'return out->out && packet[0] == (out->waits ? out->code - ONE_TRY : out->code) && size == out->size &&',
         'if (out->out && (packet[0] ^ out->code) == 8) return true;\n  return out->out && packet[0] == out->code && size == out->size &&', '4.2-4'),
    Kind('its FBC begins with 0', NODE, 'trailer[1] = TN_UNTAKEN;', 'trailer[1] = 0;', '3.5-10'),
    Kind('its HOP begins with 1', NODE, '  packet[2] = 0;\n', '  packet[2] = 1;\n', '3.4-1'),
    Kind('no new hello when numbers are used up', NODE, 'number->without_verdict >= USED_UP', 'number->without_verdict >= 200', '4.7-2'),
    Kind('a new hello has the old boot number', NODE, '  node->new_hello = false;\n  node->boot++;', '  node->new_hello = false;', '4.7-4'),
    Kind('a new hello says that all is forgotten', NODE, '  node->remembers = true;', '  node->remembers = false;', '4.7-5'),
    Kind('a new hello goes on with the numbers', NODE, '  memset(node->numbers, 0, sizeof node->numbers);\n  node->remembers', '  node->numbers[0][TN_NODES].without_verdict = 0;\n  node->remembers', '4.7-6'),
    Kind('a hello needs somebody who takes it', NODE, '    if (hello)\n      hello_is_home(node);', '    if (hello && fbc > 0 && fbc < 255)\n      hello_is_home(node);\n    else if (hello)\n      node->hello_wanted = true;', '4.8-5 4.8-6'),
    Kind('a lost hello is not said again', NODE, 'else if (out->of == TN_OF_HELLO && outcome != TN_CANCELLED)\n    node->hello_wanted = true;', 'else\n    ;', '4.8-4'),
    Kind('refused sends are not repeated', NODE, '!interrupt && fbc == 0 && goes_again(node, out, now_of(node))', '0', '4.4-1 4.4-3'),
    Kind('refused sends are repeated without end', NODE, 'else if (now - slot->refused_since >= node->config.times.refused)', 'else if (0)', '4.4-4'),
    Kind('a refused send goes again at once, always', NODE, '  slot->due = now + slot->backoff;', '  slot->due = now + 1;', '4.4-3'),
    Kind('what nobody took is sent again', NODE, '!interrupt && fbc == 0 && goes_again(', '!interrupt && (fbc == 0 || fbc == 255) && goes_again(', '4.6-2'),
    Kind('a restart of the destination goes unnoticed', NODE, '    out->once = true;', '', '4.10-32'),
    Kind('each hello is a start', NODE, 'if ((heard || hello) && !remembers)', 'if (heard || hello)', '4.10-33'),
    Kind('a hello of anybody ends what is out', NODE, '(out->destination != source && out->destination != TN_ALL)', '0', '4.10-34'),
    # ---- beacons and breaks
    Kind('no beacons', NODE, 'node->beacon_now || now - node->beaconed >= beacon_period(node)', '0', '8.2-1'),
    Kind('beacons at half the rate', NODE, 'now - node->beaconed >= beacon_period(node)', 'now - node->beaconed >= 2 * beacon_period(node)', '8.2-2'),
    Kind('beacons of 25 bytes', NODE, 'TN_ALL, CONTROL, BEACON_SIZE + 12)', 'TN_ALL, CONTROL, BEACON_SIZE + 11)', '3.9-4 3.9-13'),
    Kind('beacons name the wrong upstream neighbour', NODE, 'beacon[19] = node->input.sender;', 'beacon[19] = node->config.id;', '3.9-9'),
    Kind('beacons name the wrong downstream neighbour', NODE, 'beacon[21] = neighbour(node, node->output.at);', 'beacon[21] = 0;', '3.9-11'),
    Kind('beacons say that the lines are down', NODE, 'return up ? 1 : was_up ? 2 : 0;', 'return up ? 0 : was_up ? 2 : 0;', '3.9-8 3.9-10'),
    Kind('beacons have a CPU state that there is not', NODE, 'beacon[13] = RUNNING;', 'beacon[13] = 6;', '3.9-7'),
    Kind('beacons have another boot number', NODE, '  tn_put64(beacon + 1, node->boot);', '  tn_put64(beacon + 1, node->boot + 4);', '3.9-14 4.7-4 4.8-12 8.4-1'),
    Kind('no break is told', NODE, 'beacon[22] = node->break_known;', 'beacon[22] = 0;', '8.3-1'),
    Kind('a break is told at once', NODE, 'node->grace = now_of(node) + node->config.times.break_grace;', 'node->grace = now_of(node);', '8.3-2'),
    Kind('a break is told the wrong way round', NODE, 'beacon[23] = node->break_known ? node->break_before : 0;', 'beacon[23] = node->break_known ? node->break_behind : 0;', '8.3-3'),
    Kind('a break is never over', NODE, 'beacon[22] = node->break_known;', 'beacon[22] = (node->output.candidates[TN_NODES - 1].busy |= node->break_known);', '8.3-2 8.3-3 8.3-4'),
    Kind('it does not start over', NODE, 'if (node->in_lost && node->out_lost)', 'if (0)', '4.8-11 4.8-12 4.8-13'),
    Kind('it starts over with the old boot number', NODE, 'forget_before_loss);\n  node->boot++;', 'forget_before_loss);', '4.8-12'),
    # ---- lines
    Kind('version 2 on the line', WIRE, 'VERSION = 3, LAST_TYPE', 'VERSION = 2, LAST_TYPE', '6.5-1'),
    Kind('the hash of the ring is of another text', NODE, 'node->ring = tn_hash(TN_FNV, config->ring);', 'node->ring = tn_hash(TN_FNV, config->ring) ^ 1;', '6.5-2'),
    Kind('a connect has a whole session', LINK, '(uint64_t)candidate->number << 32, 0, 0,', '(uint64_t)candidate->number << 32 | 7, 0, 0,', '6.7-2'),
    Kind('a connect without hashes', LINK, '              node->config.agreement, TN_AGREEMENT);', '              node->config.agreement, 0);', '6.13-1 6.13-2'),
    Kind('each connect has another number', LINK, '  candidate->due = now + CONNECT_TICKS', '  candidate->number = drawn(node);\n  candidate->due = now + CONNECT_TICKS', '6.7-4'),
    Kind('all nodes are asked at once', LINK, 'only_first ? 1 : node->config.count; for (uint8_t i = 0; i < end; i++) { ask(node, i, now); if (!output->candidates[i].passed_over) break;',
         'only_first ? 2 : node->config.count;\n  for (uint8_t i = 0; i < end; i++) {\n    ask(node, i, now);', '6.9-1 6.9-2'),
    Kind('nodes beyond a living one are asked', LINK, 'if (!output->candidates[i].passed_over) break;', '', '6.9-2'),
    Kind('a busy successor is bypassed', LINK, 'candidate->passed_over = !busy;', 'candidate->passed_over = true;', '6.9-2'),
    Kind('a dead successor is waited for', LINK, '    candidate->passed_over = true;\n  }\n  if', '    ;\n  }\n  if', '6.9-4'),
    Kind('no bypass ends', LINK, 'const uint8_t end = output->up ? output->at', 'const uint8_t end = output->up ? 0', '6.9-6'),
    Kind('sequences begin at 0', LINK, '  output->sequence = 1;', '  output->sequence = 0;', '6.7-7'),
    Kind('slices in the wrong session', LINK, 'TN_SLICES, output->session, 0,', 'TN_SLICES, output->session ^ 1, 0,', '6.7-6'),
    Kind('slices that name the neighbour as sender', LINK, '  header.sender = node->config.id;', '  header.sender = type == TN_SLICES ? 5 : node->config.id;', '6.5-6'),
    Kind('no signs of life downstream', LINK, '  if (output->up)\n    tn_link_write(node, TN_IDLE, NULL, 0);', '', '6.10-1'),
    Kind('no signs of life upstream', LINK, '  if (input->up)\n    send_header(node, input->from, TN_ALIVE', '  if (0)\n    send_header(node, input->from, TN_ALIVE', '6.10-4'),
    Kind('a silent upstream neighbour is kept', LINK, 'input->silent >= times->silence || passed', 'passed', '6.10-5'),
    Kind('an upstream neighbour is lost too soon', LINK, 'input->silent >= times->silence || passed', 'input->silent >= times->silence / 4 || passed', '6.10-6'),
    Kind('a silent downstream neighbour is kept', LINK, 'output->up && output->silent >= times->silence', '0', '6.10-2'),
    Kind('a downstream neighbour is lost too soon', LINK, 'output->up && output->silent >= times->silence', 'output->up && output->silent >= times->silence / 2', '6.10-3'),
    Kind('any accept is taken', LINK, 'return candidate->asked && (uint32_t)(header->session >> 32) == candidate->number ? candidate : NULL;', 'return candidate;', '6.7-11'),
    Kind('headers of another ring are heeded', LINK, '(header.ring != node->ring && !asks)', '0', '6.7-10 6.7-25'),
    Kind('versions are not compared', LINK, '  if (header->version != 3)\n    return TN_WRONG_VERSION;', '', '6.8-2 6.8-6'),
    Kind('rings are not compared', LINK, '  if (header->ring != node->ring)\n    return TN_WRONG_RING;', '', '6.8-3'),
    Kind('ring files are not compared', LINK, '  if (*parts != 0)\n    return TN_OTHER_RING_FILE;', '', '6.13-3 6.13-4 6.13-5 6.13-6 6.13-7 6.13-8 6.13-9 6.13-10'),
    Kind('a refusal does not say which parts differ', LINK, '(uint8_t)refusal, parts, NULL', '(uint8_t)refusal, 0, NULL', '6.13-10'),
    Kind('the last hash is not compared', LINK, 'i < TN_AGREEMENT / 8;', 'i < TN_AGREEMENT / 8 - 1;', '6.13-9 6.13-10'),
    Kind('strange nodes are accepted', LINK, '    return TN_NOT_IN_RING;', '    return TN_NO_REFUSAL;', '6.8-4'),
    Kind('farther nodes are accepted', LINK, '    return TN_BUSY;\n', '    return TN_NO_REFUSAL;\n', '6.8-5'),
    Kind('an accept with half a session', LINK, 'session = (uint64_t)number << 32 | drawn(node);', 'session = (uint64_t)number << 32;', '6.7-13'),
    Kind('a new answer to each connect', LINK, '(uint32_t)(session >> 32) != number) {', 'true) {', '6.7-16'),
    Kind('a connect takes the line down', LINK, 'offer->since = node->port.now(node->port.context);', 'offer->since = node->port.now(node->port.context); lose_input(node, TN_REPLACED);', '6.3-1 6.7-12 6.7-16 6.7-17 6.7-18 6.7-20 6.7-21 6.8-1'),
    Kind('who is replaced is not told', LINK, '  send_header(node, input->from, TN_REFUSE, input->session, reason, 0, NULL, 0);', '  if (reason != TN_REPLACED) send_header(node, input->from, TN_REFUSE, input->session, reason, 0, NULL, 0);', '6.7-21'),
    Kind('slices of no session are ignored', LINK, '    send_header(node, from, TN_REFUSE, header->session, TN_UNKNOWN_SESSION, 0, NULL, 0);\n    return false;', '    return false;', '6.7-22'),
    Kind('`bye` is ignored', LINK, 'lose_input(node, TN_UNKNOWN_SESSION);\n  } else if', ';\n  } else if', '6.7-24 8.4-1'),
    Kind('doubled datagrams count twice', LINK, '    node->counters.datagrams_duplicate++;\n    return;', '    tn_slice(node, bytes[1], bytes + 4, size - 4);\n    return;', '6.7-26 6.7-27'),
    Kind('a gap ends the session', LINK, '    node->counters.datagrams_lost += missing;', '    lose_input(node, TN_UNKNOWN_SESSION);', '6.7-28 6.7-29'),
    Kind('a gap in the datagrams goes unnoticed', LINK, '    tn_gap(node);\n  }\n  input->next', '    ;\n  }\n  input->next', '6.7-29'),
    Kind('a malformed slice goes unnoticed', LINK, '    node->counters.malformed++;\n    tn_gap(node);', '    node->counters.malformed++;', '6.2-2 6.2-3 6.2-4 6.2-5 6.2-6 6.2-7 6.2-8'),
    Kind('a DATP goes on over a new line', NODE, 'void tn_input_lost(tn_node* node) { tn_gap(node);', 'void tn_input_lost(tn_node* node) {', '6.3-1'),
]


def read(name):
    with open(os.path.join(SOURCES, name), encoding='utf-8') as file:
        return file.read()


def run_compiler(compiler, *arguments):
    """@return what it says where it fails"""
    made = subprocess.run([compiler, '-std=c11', '-O1', '-w', '-fPIC', '-I', SOURCES, *arguments], capture_output=True, text=True, check=False)
    return '' if made.returncode == 0 else made.stderr[:500] or 'the compiler failed'


def right_object(name, folder):
    return os.path.join(folder, os.path.basename(name) + '.o')


def build(kind, compiler, folder, index):
    """@return the library's path, or a problem"""
    objects = []
    for name in FILES:
        if kind is None or name != kind.file:
            objects.append(right_object(name, folder))
        else:
            text = read(name)
            anchor = re.compile(r'\s+'.join(map(re.escape, kind.text.split())))  # however it is broken into lines
            if len(anchor.findall(text)) != 1:
                return None, 'its text stands %d times in %s, not once' % (len(anchor.findall(text)), name)
            text = anchor.sub(lambda _: kind.instead, text)
            objects.append(os.path.join(folder, '%d_%s' % (index, os.path.basename(name))))
            with open(objects[-1], 'w', encoding='utf-8') as out:
                out.write(text)
    library = os.path.join(folder, '%d.so' % index)
    problem = run_compiler(compiler, '-shared', *objects, '-o', library)
    return (None, problem) if problem else (library, None)


def failed_cases(library):
    """@return the numbers of the cases that it fails, or a problem"""
    results = library[:-3] + '.json'
    run = subprocess.run(['timeout', '300', sys.executable, os.path.join(ROOT, 'conform', 'conform'), '--profile', 'full', '--quiet', '--library', library,
                          '--json', results], capture_output=True, text=True, check=False)
    if not os.path.exists(results):
        return None, 'the kit ended with %d: %s' % (run.returncode, (run.stdout + run.stderr)[-300:])
    with open(results, encoding='utf-8') as file:
        cases = json.load(file)['cases']
    return [case['number'] for case in cases if case['verdict'] == 'failed'], None


def try_kind(arguments):
    kind, compiler, folder, index = arguments
    library, problem = build(kind, compiler, folder, index)
    return failed_cases(library) if library else (None, problem)


def judged(kind, failed, problem):
    """@return in words what is not as the table says; nothing if all is"""
    wanted = kind.cases.split() if kind else []
    if problem:
        return problem
    words = []
    if kind and not wanted:
        words.append('the table names no case')
    for title, numbers in (('not failed by', set(wanted) - set(failed)), ('failed as well by', set(failed) - set(wanted))):
        if numbers:
            words.append('%s %s' % (title, ' '.join(number for number in failed + wanted if number in numbers)))
    return '; '.join(words)


def table(kinds):
    return ''.join(['| what is wrong | failed by |\n|---|---|\n'] +
                   ['| %s | %s |\n' % (kind.name, ', '.join(kind.cases.split())) for kind in kinds])


def page_is_right():
    with open(os.path.join(ROOT, 'docs', 'reference', 'conformance.md'), encoding='utf-8') as page:
        return table(KINDS) in page.read()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--table', action='store_true', help='print the kinds as a table of Markdown, and end')
    parser.add_argument('--only', help='the kind with this in its name')
    parser.add_argument('--compiler', default=os.environ.get('CONFORM_COMPILER', 'cc'))
    options = parser.parse_args()
    kinds = [kind for kind in KINDS if not options.only or options.only in kind.name]
    if options.table:
        print(table(kinds), end='')
        return 0
    wrong = 0
    if not options.only and not page_is_right():
        print('docs/reference/conformance.md has another table than --table prints')
        wrong = 1
    with tempfile.TemporaryDirectory(prefix='wrong_nodes_') as folder, concurrent.futures.ThreadPoolExecutor(WORKERS) as pool:
        for name in FILES:
            problem = run_compiler(options.compiler, '-c', os.path.join(SOURCES, name), '-o', right_object(name, folder))
            if problem:
                sys.exit(problem)
        work = [(kind, options.compiler, folder, index) for index, kind in enumerate([None] + kinds)]
        for (kind, *_), (failed, problem) in zip(work, pool.map(try_kind, work)):
            words = judged(kind, failed, problem)
            wrong += bool(words)
            if words:
                print('%s: %s' % (kind.name if kind else 'the right node', words), flush=True)
    print('%d wrong nodes, each failed by the cases about it: %s' % (len(kinds), 'yes' if not wrong else 'NO, %d are not' % wrong))
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main())
