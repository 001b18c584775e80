#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <vector>

#include "io/admission.h"
#include "io/input.h"
#include "io/memory_line.h"
#include "io/node_clock.h"
#include "io/unix_listener.h"

namespace limb_ring::link {

/// The receiving end on a UNIX-domain stream socket: the listening socket, pending connections and one stream, whose
/// slices come through the socket or through shared memory, as the other end asks for.
class UnixInput final : public InputLine,
                        public std::enable_shared_from_this<UnixInput>,
                        private PendingConnection::Owner,
                        private UnixStream::Owner {
 public:
  /// @throw std::runtime_error if it cannot listen, with the path and the cause
  UnixInput(boost::asio::io_context& io, const InputSettings& settings, InputHandler& handler, InputReport& report,
            Upstream& upstream);
  void start() { accept(); }
  void close() override;
  bool is_in_place() const override;
  void listen_again() override;
  std::optional<std::uint8_t> from() const override;
  void replace(std::uint8_t by) override;

 private:
  void accept();
  void welcome(event_loop::UnixSocket socket);
  void on_greeted(const std::shared_ptr<PendingConnection>& connection, const LinkHeader& connect,
                  const Agreement& theirs) override;
  void on_unknown_peer(const std::shared_ptr<PendingConnection>& connection, std::string_view why) override;
  void on_heard() override { silence_.heard(); }
  bool stood_still() const override { return silence_.stood_still(Clock::now()); }
  bool was_suspended() override { return suspension_.noticed(); }
  void on_ended(std::string_view reason) override { lose(reason); }

  void turn_away(PendingConnection& connection, const LinkHeader& connect, const LinkHeader& refuse);
  void admit(PendingConnection& connection, const LinkHeader& connect);
  std::shared_ptr<UnixStream> make_stream(PendingConnection& connection, std::optional<QueueMemory> memory,
                                          process::UniqueFd wake);
  void lose(std::string_view reason);
  void let_go(const std::shared_ptr<PendingConnection>& connection);
  void tick(Time now);
  void tick_pending(Time now);

  boost::asio::io_context& io_;
  InputSettings settings_;
  InputHandler& handler_;
  InputReport& report_;
  Upstream& upstream_;
  Admission admission_;
  event_loop::UnixListener listener_;
  std::vector<std::shared_ptr<PendingConnection>> pending_;
  std::shared_ptr<UnixStream> stream_;
  std::uint8_t from_ = 0;
  Silence silence_;
  Suspension suspension_;
  event_loop::Ticker ticker_;
  bool accepting_ = false;
  bool closed_ = false;
};

}  // namespace limb_ring::link
