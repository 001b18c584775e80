// HostPort: every wait has a deadline, lets other Python threads run, and ends by Ctrl-C.
#include <algorithm>
#include <atomic>
#include <memory>

#include "bindings.h"
#include "client/arguments.h"

namespace limb_ring::python {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

/// How long a wait may leave a signal of Python's unseen.
constexpr milliseconds kSlice{50};
constexpr double kLongest = 1e6;  // s

nanoseconds wanted(double timeout) {
  if (!(timeout >= 0)) throw py::value_error("timeout: 0 s or more is needed, not " + std::to_string(timeout));
  return std::chrono::ceil<nanoseconds>(std::chrono::duration<double>(std::min(timeout, kLongest)));
}

milliseconds whole(nanoseconds time) { return std::chrono::ceil<milliseconds>(time); }

void look_for_signals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

/// Calls `step(slice)` without the GIL until it says true or the time is over. The time is that of its waits, so that
/// it is the ring's where the ring has a clock of its own.
template <typename Step>
void in_slices(nanoseconds left, Step step) {
  for (bool done = false; !done;) {
    const nanoseconds slice = std::min<nanoseconds>(left, kSlice);
    {
      py::gil_scoped_release others_may_run;
      done = step(slice);
    }
    left -= slice;
    if (left <= nanoseconds{0}) done = true;
    if (!done) look_for_signals();
  }
}

/// The last look before `message` goes to Python. If a signal's handler raises now, nobody gets what is returned: it
/// goes to `keep`, for whoever asks next.
void look_for_signals_before(const std::optional<Message>& message, const py::object& keep) {
  try {
    look_for_signals();
  } catch (py::error_already_set&) {
    if (message) keep(*message);
    throw;
  }
}

/// For waits of the library's that may be longer than a slice, or have no end.
void look_for_signals_meanwhile() {
  const py::gil_scoped_acquire look;
  look_for_signals();
}

HostPort connect(const std::string& ring, const std::string& node, const std::string& role, double timeout,
                 double alive_period, bool restarted_by_owner, bool results_may_wait, bool lockstep,
                 const std::string& runtime, bool asks_only) {
  ConnectOptions options;
  options.ring = ring;
  options.node = node;
  if (role != "tool" && role != "cpu") throw py::value_error("role: 'tool' or 'cpu' is needed, not '" + role + "'");
  options.role = role == "cpu" ? Role::cpu : Role::tool;
  options.alive_period = whole(wanted(alive_period));
  options.restarted_by_owner = restarted_by_owner;
  options.results_may_wait = results_may_wait;
  options.lockstep = lockstep;
  options.runtime = runtime;
  options.asks_only = asks_only;
  options.timeout = whole(wanted(timeout));
  options.meanwhile = look_for_signals_meanwhile;
  py::gil_scoped_release others_may_run;
  return HostPort::connect(options);
}

std::optional<Message> receive(HostPort& port, double timeout, const py::object& keep) {
  std::optional<Message> message;
  in_slices(wanted(timeout), [&](nanoseconds slice) {
    message = port.receive(slice);
    return message || !port.connected();
  });
  look_for_signals_before(message, keep);
  return message;
}

/// What ask(milliseconds) returns; nothing if it has timed out in every slice.
template <typename Answer, typename Ask>
std::optional<Answer> answer_in_slices(double timeout, Ask ask) {
  std::optional<Answer> answer;
  in_slices(wanted(timeout), [&](nanoseconds slice) {
    try {
      answer = ask(whole(slice));
    } catch (const HostPortTimeout&) {
    }
    return answer.has_value();
  });
  return answer;
}

Result wait(HostPort& port, std::uint32_t token, double timeout, const py::object& keep) {
  const auto result =
      answer_in_slices<Result>(timeout, [&](std::chrono::milliseconds slice) { return port.wait(token, slice); });
  look_for_signals_before(result, keep);
  if (result) return *result;
  throw HostPortTimeout("token " + std::to_string(token) + ": no result within " + std::to_string(timeout) + " s");
}

void sleep_until(HostPort& port, std::int64_t until_ns) {
  const std::chrono::nanoseconds until{until_ns};
  for (bool on = true; on;) {
    {
      py::gil_scoped_release others_may_run;
      port.sleep_until(std::min<nanoseconds>(until, port.now() + kSlice));
      on = port.connected() && port.now() < until;
    }
    look_for_signals();
  }
}

std::string reply_to(HostPort& port, std::uint32_t token, double timeout, const py::object& keep) {
  const auto reply =
      answer_in_slices<std::string>(timeout, [&](std::chrono::milliseconds slice) { return port.reply(token, slice); });
  look_for_signals_before(reply ? std::optional<Message>(Reply{token, *reply}) : std::nullopt, keep);
  if (reply) return *reply;
  throw HostPortTimeout("node " + port.name() + " of ring " + port.ring() + " did not answer within " +
                        std::to_string(timeout) + " s");
}

/// The port of a `with`, which may be closed before Python forgets it.
struct Port {
  explicit Port(HostPort opened) : port(std::move(opened)) {}

  std::optional<HostPort> port;
  std::atomic<bool> in_use{false};
};

/// A port in use by one thread: a HostPort is for one, and while it waits others run.
class Use {
 public:
  explicit Use(Port& port) : port_(port) {
    if (port_.in_use.exchange(true)) throw HostPortError("this host port is in use by another thread");
    if (port_.port) return;
    port_.in_use = false;
    throw HostPortError("this host port is closed");
  }
  ~Use() { port_.in_use = false; }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;

  HostPort* operator->() { return &*port_.port; }
  HostPort& operator*() { return *port_.port; }

 private:
  Port& port_;
};

bool is_connected(Port& port) { return port.port && Use(port)->connected(); }

void close(Port& port) {
  if (!port.port) return;
  const Use use(port);
  port.port.reset();
}

}  // namespace

void bind_port(py::module& module) {
  module.attr("EVENT_KINDS") = py::tuple(py::cast(client::event_kinds()));

  const auto error = py::register_exception<HostPortError>(module, "HostPortError", PyExc_RuntimeError);
  const auto both = py::make_tuple(error, py::reinterpret_borrow<py::object>(PyExc_TimeoutError));
  py::register_exception<HostPortTimeout>(module, "HostPortTimeout", both.ptr());

  // What may wait for the daemon lets other threads run. The waits of receive() and its kind do so by themselves.
  using LetOthersRun = py::call_guard<py::gil_scoped_release>;
  py::class_<Port>(module, "Port")
      .def(py::init([](const std::string& ring, const std::string& node, const std::string& role, double timeout,
                       double alive_period, bool restarted_by_owner, bool results_may_wait, bool lockstep,
                       const std::string& runtime, bool asks_only) {
        return std::make_unique<Port>(connect(ring, node, role, timeout, alive_period, restarted_by_owner,
                                              results_may_wait, lockstep, runtime, asks_only));
      }))
      .def_property_readonly("id", [](Port& p) { return Use(p)->id(); })
      .def_property_readonly("name", [](Port& p) { return Use(p)->name(); })
      .def_property_readonly("ring", [](Port& p) { return Use(p)->ring(); })
      .def_property_readonly("connected", &is_connected)
      .def_property_readonly("in_lockstep", [](Port& p) { return Use(p)->in_lockstep(); })
      .def("fileno", [](Port& p) { return Use(p)->fd(); })
      .def("close", &close)
      .def(
          "send",
          [](Port& p, std::uint8_t to, const std::string& data, std::uint8_t priority, std::uint8_t channel) {
            return Use(p)->send(to, view(data).data, data.size(), priority, channel);
          },
          LetOthersRun())
      .def(
          "interrupt",
          [](Port& p, std::uint8_t to, std::uint8_t factor, bool force) {
            return Use(p)->interrupt(to, factor, force);
          },
          LetOthersRun())
      .def(
          "pull", [](Port& p, std::uint8_t input) { return Use(p)->pull(input); }, LetOthersRun())
      .def(
          "request", [](Port& p, const std::string& json) { return Use(p)->request(json); }, LetOthersRun())
      .def(
          "observe", [](Port& p, const std::string& json) { Use(p)->observe(json); }, LetOthersRun())
      .def(
          "now_ns", [](Port& p) { return Use(p)->now().count(); }, LetOthersRun())
      .def(
          "stamp_ns", [](Port& p) { return Use(p)->stamp().count(); }, LetOthersRun())
      .def(
          "age_ns", [](Port& p, std::int64_t stamp_ns) { return Use(p)->age_of(stamp_ns).count(); }, LetOthersRun())
      .def(
          "alive", [](Port& p) { Use(p)->alive(); }, LetOthersRun())
      .def(
          "tell_stopped", [](Port& p, bool stopped) { Use(p)->tell_stopped(stopped); }, LetOthersRun())
      .def("sleep_until", [](Port& p, std::int64_t until_ns) { sleep_until(*Use(p), until_ns); })
      .def("receive", [](Port& p, double timeout, const py::object& keep) { return receive(*Use(p), timeout, keep); })
      .def("wait", [](Port& p, std::uint32_t token, double timeout,
                      const py::object& keep) { return wait(*Use(p), token, timeout, keep); })
      .def("reply", [](Port& p, std::uint32_t token, double timeout, const py::object& keep) {
        return reply_to(*Use(p), token, timeout, keep);
      });
}

}  // namespace limb_ring::python
