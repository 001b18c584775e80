#include "link/unix_input.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

namespace limb_ring::link {
namespace {

constexpr std::size_t kMaxGuests = 16;
/// A guest may take so many times `silence` to say who it is.
constexpr int kGuestPatience = 4;

}  // namespace

UnixInput::UnixInput(boost::asio::io_context& io, const InputSettings& settings,
                     InputHandler& handler, InputReport& report)
    : io_(io),
      settings_(settings),
      handler_(handler),
      report_(report),
      admission_(settings.self, settings.order),
      acceptor_(listen_unix(io, settings.endpoint.path)),
      silence_(settings.timing),
      ticker_(io, settings.timing.idle, [this](Time now) { tick(now); }) {}

void UnixInput::close() {
  if (closed_) return;
  closed_ = true;
  ticker_.stop();
  boost::system::error_code ignored;
  acceptor_.close(ignored);
  ::unlink(settings_.endpoint.path.c_str());
  for (const auto& guest : guests_) guest->close();
  guests_.clear();
  if (stream_) stream_->close();
  stream_.reset();
}

/// The accept under way ends with the old socket; the next tick begins another.
void UnixInput::listen_again() { acceptor_ = listen_unix(io_, settings_.endpoint.path); }

std::optional<std::uint8_t> UnixInput::from() const {
  if (!stream_) return {};
  return from_;
}

void UnixInput::accept() {
  accepting_ = true;
  acceptor_.async_accept(
      [self = shared_from_this()](const boost::system::error_code& error, UnixSocket socket) {
        if (self->closed_) return;
        self->accepting_ = false;  // after an error (no descriptors left) the tick goes on
        if (error) return;
        self->welcome(std::move(socket));
        self->accept();
      });
}

void UnixInput::welcome(UnixSocket socket) {
  if (!same_user(socket.native_handle())) {
    return report_.stranger("a process of another user was turned away");
  }
  enlarge_buffers(socket.native_handle());
  if (guests_.size() == kMaxGuests) on_stranger(guests_.front(), "too many pending connections; this was the oldest");
  UnixGuest::Host& host = *this;
  guests_.push_back(std::make_shared<UnixGuest>(std::move(socket), host, Clock::now()));
  guests_.back()->start();
}

void UnixInput::on_stranger(const std::shared_ptr<UnixGuest>& guest, std::string_view why) {
  report_.stranger(std::string(why));
  guest->close();
  let_go(guest);
  if (why == kNoNode && report_.first_time(why)) handler_.on_stranger(why);
}

void UnixInput::on_greeted(const std::shared_ptr<UnixGuest>& guest, const Head& connect) {
  let_go(guest);
  const Refusal refusal = admission_.judge(connect, from());
  if (guest->hung_up()) {
    guest->close();
  } else if (refusal != Refusal::none) {
    turn_away(*guest, connect, refusal);
  } else {
    admit(*guest, connect);
  }
}

void UnixInput::turn_away(UnixGuest& guest, const Head& connect, Refusal refusal) {
  if (refusal == Refusal::busy) {
    ++report_.counters.refused;
  } else {
    report_.stranger(why_unfit(connect, refusal));
  }
  guest.answer(head(HeadType::refuse, refusal));
  guest.close();
  const std::string& why = report_.last_stranger;
  if (refusal != Refusal::busy && report_.first_time(why)) handler_.on_stranger(why);
}

void UnixInput::admit(UnixGuest& guest, const Head& connect) {
  Head accept = head(HeadType::accept);
  accept.session = connect.session;
  guest.answer(accept);
  UnixSocket socket = guest.release();
  if (stream_) replace(connect.sender);
  if (closed_) return;
  UnixStream::Owner& owner = *this;
  stream_ = std::make_shared<UnixStream>(std::move(socket), owner, handler_, report_.counters);
  from_ = connect.sender;
  silence_.restart(Clock::now());
  ++report_.counters.connects;
  report_.first_time.forget();
  stream_->start();
  handler_.on_input_up(from_);
}

void UnixInput::replace(std::uint8_t by) {
  ++report_.counters.replaced;
  stream_->tell(head(HeadType::refuse, Refusal::replaced));
  lose("replaced by node " + std::to_string(by));
}

void UnixInput::lose(std::string_view reason) {
  ++report_.counters.losses;
  stream_->close();
  stream_.reset();
  handler_.on_input_lost(reason);
}

void UnixInput::let_go(const std::shared_ptr<UnixGuest>& guest) {
  guests_.erase(std::remove(guests_.begin(), guests_.end(), guest), guests_.end());
}

void UnixInput::tick(Time now) {
  tick_guests(now);
  if (!closed_ && !accepting_) accept();
  if (!stream_) return;
  stream_->tell(head(HeadType::alive));
  if (!silence_.tick(now)) return;
  stream_->read();  // this end may not have been scheduled: see what has come
  if (!stream_ || !silence_.still()) return;
  ++report_.counters.silences;
  lose(kSilent);
}

void UnixInput::tick_guests(Time now) {
  const auto guests = guests_;
  for (const auto& guest : guests) {
    if (now - guest->since() < kGuestPatience * settings_.timing.silence) continue;
    if (guest->open()) guest->read();
    if (guest->open()) on_stranger(guest, "it did not say who it is");
  }
}

Head UnixInput::head(HeadType type, Refusal refusal) const {
  Head head;
  head.type = type;
  head.ring = settings_.self.ring;
  head.sender = settings_.self.id;
  head.refusal = refusal;
  return head;
}

}  // namespace limb_ring::link
