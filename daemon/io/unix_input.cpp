#include "io/unix_input.h"

#include <sys/socket.h>

#include <algorithm>
#include <system_error>
#include <utility>

namespace limb_ring::link {
namespace {

constexpr std::size_t kMaxPending = 16;

}  // namespace

UnixInput::UnixInput(boost::asio::io_context& io, const InputSettings& settings, InputHandler& handler,
                     InputReport& report, Upstream& upstream)
    : io_(io),
      settings_(settings),
      handler_(handler),
      report_(report),
      upstream_(upstream),
      admission_(settings.self, settings.order, settings.names),
      listener_(io, settings.endpoint.path),
      silence_(settings.timing),
      suspension_(settings.several_hosts, settings.timing.silence),
      ticker_(io, settings.timing.idle, [this](Time now) { tick(now); }) {}

void UnixInput::close() {
  if (closed_) return;
  closed_ = true;
  ticker_.stop();
  listener_.close();
  for (const auto& connection : pending_) connection->close();
  pending_.clear();
  if (stream_) stream_->close();
  stream_.reset();
}

bool UnixInput::is_in_place() const { return listener_.is_in_place(); }

/// The accept under way ends with the old socket; the next tick begins another.
void UnixInput::listen_again() { listener_.listen_again(); }

std::optional<std::uint8_t> UnixInput::from() const {
  if (!stream_) return {};
  return from_;
}

void UnixInput::accept() {
  accepting_ = true;
  listener_.acceptor().async_accept(
      [self = shared_from_this()](const boost::system::error_code& error, event_loop::UnixSocket socket) {
        if (self->closed_) return;
        self->accepting_ = false;  // after an error (no descriptors left) the tick goes on
        if (error) return;
        self->welcome(std::move(socket));
        self->accept();
      });
}

void UnixInput::welcome(event_loop::UnixSocket socket) {
  if (!process::is_of_our_user(socket.native_handle())) {
    return report_.unknown_peer("a process of another user was turned away");
  }
  enlarge_buffers(socket.native_handle());
  if (pending_.size() == kMaxPending) {
    const auto oldest = pending_.front();  // the list lets go of it on the way
    on_unknown_peer(oldest, "too many pending connections; this was the oldest");
  }
  PendingConnection::Owner& owner = *this;
  pending_.push_back(std::make_shared<PendingConnection>(std::move(socket), owner, Clock::now()));
  pending_.back()->start();
}

void UnixInput::on_unknown_peer(const std::shared_ptr<PendingConnection>& connection, std::string_view why) {
  report_.unknown_peer(std::string(why));
  connection->close();
  let_go(connection);
  if (why == kNoNode && report_.report_once(why)) handler_.on_unknown_peer(why);
}

void UnixInput::on_greeted(const std::shared_ptr<PendingConnection>& connection, const LinkHeader& connect,
                           const Agreement& theirs) {
  let_go(connection);
  const auto refuse = admission_.judge(connect, theirs, upstream_.from());
  if (connection->hung_up()) {
    connection->close();
  } else if (refuse) {
    turn_away(*connection, connect, *refuse);
  } else {
    admit(*connection, connect);
  }
}

void UnixInput::turn_away(PendingConnection& connection, const LinkHeader& connect, const LinkHeader& refuse) {
  connection.answer(refuse);
  connection.close();
  report_.turned_away(admission_.label(connect.sender), connect, refuse, handler_);
}

void UnixInput::admit(PendingConnection& connection, const LinkHeader& connect) {
  std::optional<QueueMemory> memory;
  process::UniqueFd wake;
  if (connect.type == LinkHeaderType::connect_memory) {
    auto given = std::exchange(connection.descriptors(), {});
    if (given.size() == kMostDescriptors) {
      memory = QueueMemory::open(std::move(given[0]));
      wake = open_wake(given[1]);
    }
    if (!memory || !wake.valid())
      return turn_away(connection, connect, admission_.header(LinkHeaderType::refuse, Refusal::invalid_memory));
  }
  LinkHeader accept = admission_.header(LinkHeaderType::accept);
  accept.session = connect.session;
  connection.answer(accept);
  auto stream = make_stream(connection, std::move(memory), std::move(wake));
  if (!stream) return report_.unknown_peer(admission_.label(connect.sender) + ": cannot wait for what it sends");
  upstream_.give_way(connect.sender);
  if (closed_) return;
  upstream_.comes_by(*this);
  stream_ = std::move(stream);
  from_ = connect.sender;
  silence_.restart(Clock::now());
  report_.came_up(from_);
  handler_.on_input_up(from_);
}

std::shared_ptr<UnixStream> UnixInput::make_stream(PendingConnection& connection, std::optional<QueueMemory> memory,
                                                   process::UniqueFd wake) {
  UnixStream::Owner& owner = *this;
  const LinkHeader alive = admission_.header(LinkHeaderType::alive);
  InputCounters& counters = report_.counters;
  process::UniqueFd socket = connection.release();
  try {
    if (!memory) return std::make_shared<UnixStream>(io_, std::move(socket), alive, owner, handler_, counters);
    return std::make_shared<MemoryStream>(io_, std::move(socket), std::move(*memory), std::move(wake), alive, owner,
                                          handler_, counters);
  } catch (const std::system_error&) {
    return nullptr;  // the kernel watches no more descriptors for us
  }
}

void UnixInput::replace(std::uint8_t by) {
  ++report_.counters.replaced;
  stream_->tell(admission_.header(LinkHeaderType::refuse, Refusal::replaced));
  lose("replaced by node " + std::to_string(by));
}

void UnixInput::lose(std::string_view reason) {
  ++report_.counters.losses;
  stream_->close();
  stream_.reset();
  handler_.on_input_lost(reason);
}

void UnixInput::let_go(const std::shared_ptr<PendingConnection>& connection) {
  pending_.erase(std::remove(pending_.begin(), pending_.end(), connection), pending_.end());
}

void UnixInput::tick(Time now) {
  tick_pending(now);
  if (!closed_ && !accepting_) accept();
  if (stream_ && silence_.stood_still(now)) stream_->read();
  if (!stream_) return;
  stream_->tick();
  if (!silence_.tick(now)) return;
  stream_->read();  // this end may not have been scheduled: see what has come
  if (!stream_ || !silence_.still()) return;
  ++report_.counters.silences;
  lose(kSilent);
}

void UnixInput::tick_pending(Time now) {
  const auto pending = pending_;
  for (const auto& connection : pending) {
    if (now - connection->since() < settings_.timing.handshake()) continue;
    if (connection->open()) connection->read();
    if (connection->open()) on_unknown_peer(connection, "it did not say who it is");
  }
}

}  // namespace limb_ring::link
