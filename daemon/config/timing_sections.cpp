#include "config/sections.h"

namespace limb_ring::config {

using namespace std::chrono_literals;

namespace {

constexpr IntegerRange kInsertionBuffer{2, 1024};

}  // namespace

const Section<Limits>& limits_section() {
  static const Section<Limits> section{
      {"insertion_buffer", "8; at lines with a rate the number of nodes, if more", allowed(kInsertionBuffer),
       "Room for so many DATPs of 524 bytes that wait to be relayed; one more is dropped, counted. Where a line has a "
       "rate, a packet of each other node may wait.",
       [](const Entry& entry, Limits& limits) {
         limits.insertion_buffer = static_cast<unsigned>(read_integer(entry, kInsertionBuffer));
       }},
      integer_option("interrupt_buffer", &Limits::interrupt_buffer, {2, 4096},
                     "INTPs that may wait there; one more is dropped, counted."),
      integer_option("send_queue", &Limits::send_queue, {1, 65536},
                     "Sends that may wait in a node, per priority; one more is rejected."),
      integer_option("receive_buffers", &Limits::receive_buffers, kReceiveBuffers,
                     "Packets that may wait for a CPU, per priority; one more is refused."),
      integer_option("clients", &Limits::clients, {1, 1024},
                     "Programs connected to one host port at a time; the CPU and whoever only asks (ringctl stop) have "
                     "places beside them."),
  };
  return section;
}

const Section<Timeouts>& timeouts_section() {
  static const Section<Timeouts> section{
      time_option("send", &Timeouts::send, 1ms, 60s,
                  "Least time-out of one try, from the first byte out; then it is sent again."),
      time_option("refused", &Timeouts::refused, 0ms, 60s,
                  "A unicast refused by a full receiver is tried again for so long."),
      time_option("refused_backoff", &Timeouts::refused_backoff, 1ms, 10s,
                  "Longest wait between those tries; it doubles from 1ms."),
      time_option("queue", &Timeouts::queue, 1ms, 600s,
                  "A send that is not on the line after so long ends as rejected; a retry as lost or refused."),
      time_option("stall", &Timeouts::stall, 1ms, 60s,
                  "A packet in flight of which nothing came for so long is aborted."),
      time_option("idle", &Timeouts::idle, 1ms, 10s,
                  "A quiet link sends a sign of life so often; at most half of `silence`."),
      time_option("silence", &Timeouts::silence, 2ms, 60s, "A link silent for so long counts as broken."),
      time_option("first_successor", &Timeouts::first_successor, 0ms, 60s,
                  "At the start, wait so long for the configured neighbour before it is bypassed."),
      time_option("break_grace", &Timeouts::break_grace, 0ms, 60s,
                  "A lost input counts as a broken line when no bypass has closed the gap for so long."),
      time_option("fold_permission", &Timeouts::fold_permission, 0ms, 60s,
                  "foldback: for so long after its start a node does not fold, unless both its lines have been up."),
      time_option("beacon", &Timeouts::beacon, 10ms, 60s, "Each node tells all others its state so often."),
      time_option("cpu_boot", &Timeouts::cpu_boot, 10ms, 600s,
                  "A CPU that has not connected so long after its start counts as failed."),
      time_option("command", &Timeouts::command, 1ms, 60s,
                  "A joint without a new command for so long goes to its safe state."),
  };
  return section;
}

const Section<Firmware>& firmware_section() {
  static const Section<Firmware> section{
      real_option(
          "state_rate", &Firmware::state_rate, {1, 1000, "Hz"},
          "How often a limb sends the state of its joints. limb_firmware takes what comes less than 1 ms before "
          "a sample with it, on a living ring."),
      real_option("bandwidth", &Firmware::bandwidth, {0.1, 100, "Hz"}, "Natural frequency of the simulated servo."),
      real_option("damping", &Firmware::damping, {0.05, 5, "(a ratio)"},
                  "Damping ratio of the simulated servo; 1 is critical."),
  };
  return section;
}

namespace {

constexpr const char* kCores = "auto, or a list of CPU cores, such as [0] or [2, 3]";

void read_cores(const Entry& entry, Realtime& realtime) {
  realtime.cores.clear();
  realtime.auto_cores = entry.is_scalar();
  if (realtime.auto_cores && entry.text(kCores) != "auto") entry.refuse_value("is unknown", kCores);
  if (realtime.auto_cores) return;
  for (const Entry& item : entry.items(kCores, 1024))
    realtime.cores.push_back(static_cast<unsigned>(read_integer(item, {0, 1023})));
}

}  // namespace

const Section<Realtime>& realtime_section() {
  static const Section<Realtime> section{
      {"cores", "[]", "auto, or a list of CPU cores, each 0 to 1023",
       "The daemons run on these cores only; all on one, where nothing else computes, is the fastest for one packet. "
       "auto: each on one core, neighbours together: the fastest under load. Empty: anywhere; with --clock virtual the "
       "ring and its CPUs share the core they start on.",
       read_cores},
      integer_option("fifo", &Realtime::fifo, {0, 99}, "SCHED_FIFO priority of the daemons; 0 is off."),
      flag_option("lock_memory", &Realtime::lock_memory, "Keep the daemons' memory from being paged out (mlockall)."),
      time_option("spin", &Realtime::spin, 0s, 10ms,
                  "A daemon looks for packets for so long before it sleeps: for a core of its own."),
  };
  return section;
}

}  // namespace limb_ring::config
