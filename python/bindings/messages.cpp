// What comes out of a host port: limb_ring/host_port.h and captured_packet.h, with bytes as bytes and JSON as dict.
#include "bindings.h"

namespace limb_ring::python {
namespace {

py::object parsed(const std::string& json) { return py::module::import("json").attr("loads")(json); }

std::string action_of(const Interrupt& interrupt) {
  return interrupt.action == Interrupt::Action::stop ? "stop" : "notify";
}

void bind_captured(py::module& module) {
  using C = CapturedPacket;
  py::class_<C>(module, "CapturedPacket", "A packet seen on a line of this node (observe with packets)")
      .def_readonly("time_ns", &C::time_ns, "CLOCK_REALTIME of its last slice, ns since 1970")
      .def_readonly("steady_ns", &C::steady_ns, "the same by CLOCK_MONOTONIC")
      .def_readonly("lost_before", &C::lost_before, "packets left out before this one: read too slowly")
      .def_property_readonly(
          "bytes", [](const C& c) { return to_bytes(c.bytes); }, "header to CRC, as on the line")
      .def_property_readonly("line", [](const C& c) { return py::make_tuple(c.info.from, c.info.to); })
      .def_property_readonly(
          "input", [](const C& c) { return c.info.input; }, "seen at the line's end")
      .def_property_readonly("crc_bad", [](const C& c) { return c.info.crc_bad; })
      .def_property_readonly("aborted", [](const C& c) { return c.info.aborted; })
      .def_property_readonly("truncated", [](const C& c) { return c.info.truncated; })
      .def_property_readonly("embedded", [](const C& c) { return c.info.embedded; })
      .def_property_readonly("retry", [](const C& c) { return c.info.retry; })
      .def_property_readonly("own", [](const C& c) { return c.info.own; })
      .def_property_readonly(
          "span", [](const C& c) { return seconds(c.info.span); }, "s, first slice to last")
      .def_property_readonly("carrier", [](const C& c) {
        return py::make_tuple(c.info.carrier_source, c.info.carrier_code, c.info.carrier_offset);
      });
  using Counts = CaptureCounts;
  py::class_<Counts>(module, "CaptureCounts", "What became of the packets on the lines that are observed")
      .def_readonly("seen", &Counts::seen)
      .def_readonly("filtered", &Counts::filtered)
      .def_readonly("sampled_out", &Counts::sampled_out)
      .def_readonly("limited", &Counts::limited)
      .def_readonly("lost", &Counts::lost)
      .def_readonly("given", &Counts::given);
}

void bind_json(py::module& module) {
  py::class_<Reply>(module, "Reply", "Answer to HostPort.request()")
      .def_readonly("token", &Reply::token)
      .def_property_readonly(
          "content", [](const Reply& r) { return parsed(r.json); }, "a dict; {'error': ...}: no")
      .def("__repr__",
           [](const Reply& r) { return "<Reply to token " + std::to_string(r.token) + ": " + r.json + ">"; });
  py::class_<Observed>(module, "Observed", "Something that happened (HostPort.observe())")
      .def_property_readonly(
          "content", [](const Observed& o) { return parsed(o.json); }, "a dict")
      .def("__repr__", [](const Observed& o) { return "<Observed " + o.json + ">"; });
  py::class_<ObservedLost>(module, "ObservedLost", "So many were left out before the next: read too slowly")
      .def_readonly("count", &ObservedLost::count)
      .def("__repr__", [](const ObservedLost& lost) { return "<ObservedLost " + std::to_string(lost.count) + ">"; });
}

}  // namespace

void bind_messages(py::module& module) {
  module.attr("BROADCAST") = kBroadcast;
  module.attr("MAX_PAYLOAD") = kMaxPayload;
  py::class_<Packet>(module, "Packet", "A packet for this CPU")
      .def_readonly("source", &Packet::source, "id of the node that sent it")
      .def_readonly("destination", &Packet::destination, "this node's id, or BROADCAST")
      .def_readonly("priority", &Packet::priority, "0 (highest) to 3")
      .def_readonly("channel", &Packet::channel, "0 user, 2 joint data, 3 topic fragments, 4 to 63 free")
      .def_property_readonly(
          "data", [](const Packet& p) { return to_bytes(p.data); }, "1 to 512 bytes")
      .def("__repr__", [](const Packet& p) {
        return "<Packet from " + std::to_string(p.source) + ", channel " + std::to_string(p.channel) + ", " +
               std::to_string(p.data.size()) + " bytes>";
      });
  py::class_<Interrupt>(module, "Interrupt", "A pin of this node was pulled whose action concerns the CPU")
      .def_property_readonly("action", &action_of, "'notify' or 'stop'")
      .def_readonly("source", &Interrupt::source)
      .def_readonly("factor", &Interrupt::factor, "0 to 7")
      .def("__repr__", [](const Interrupt& i) {
        return "<Interrupt INT" + std::to_string(i.factor) + " from " + std::to_string(i.source) + ": " + action_of(i) +
               ">";
      });
  py::class_<Result>(module, "Result", "The end of one send, interrupt or pull")
      .def_readonly("token", &Result::token, "what the call returned")
      .def_property_readonly(
          "outcome", [](const Result& r) { return to_string(r.outcome); },
          "'delivered', 'refused', 'no such node', 'lost', 'unconfirmed', 'rejected', 'cancelled'")
      .def_property_readonly(
          "round_trip", [](const Result& r) { return seconds(r.round_trip); }, "s; 0: none came")
      .def_readonly("tries", &Result::tries, "times put onto the line")
      .def_readonly("reason", &Result::reason, "why not, for people")
      .def_property_readonly(
          "why", [](const Result& r) { return to_string(r.why); }, "the same in one word")
      .def("__repr__", [](const Result& r) {
        return std::string("<Result ") + to_string(r.outcome) + (r.reason.empty() ? "" : ": " + r.reason) + ">";
      });
  py::class_<Disconnected>(module, "Disconnected", "The connection has ended; nothing comes after this")
      .def_readonly("reason", &Disconnected::reason)
      .def("__repr__", [](const Disconnected& end) { return "<Disconnected: " + end.reason + ">"; });
  bind_json(module);
  bind_captured(module);
}

}  // namespace limb_ring::python
