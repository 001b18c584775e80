#include "io/admission.h"

#include <algorithm>
#include <cerrno>

namespace limb_ring::link {

std::string why_unfit(const LinkHeader& connect, const LinkHeader& refuse) {
  switch (refuse.refusal) {
    case Refusal::wrong_version:
      return version_mismatch(connect.version);
    case Refusal::invalid_memory:
      return "it offers shared memory that cannot be used";
    case Refusal::needs_key:
      return "it has no key, and the lines here are keyed: give links.key in its file";
    case Refusal::no_key:
      return "it has a key, and this node has none: give links.key in the file here";
    case Refusal::not_in_ring:
      return "it is not in this ring";
    default:
      return reason_of(refuse);
  }
}

Admission::Admission(Identity self, std::vector<std::uint8_t> order, std::vector<std::string> names)
    : self_(self), order_(std::move(order)), names_(std::move(names)) {}

Refusal Admission::judge(const LinkHeader& connect, std::optional<std::uint8_t> present) const {
  if (connect.version != kLinkVersion) return Refusal::wrong_version;
  if (connect.ring != self_.ring) return Refusal::wrong_ring;
  const std::size_t asking = distance(connect.sender);
  if (asking == 0) return Refusal::not_in_ring;
  if (present && asking > distance(*present)) return Refusal::busy;
  return Refusal::none;
}

std::optional<LinkHeader> Admission::judge(const LinkHeader& connect, const Agreement& theirs,
                                           std::optional<std::uint8_t> present) const {
  const Refusal refusal = judge(connect, present);
  if (refusal == Refusal::wrong_version || refusal == Refusal::wrong_ring)
    return header(LinkHeaderType::refuse, refusal);
  if (const std::uint32_t differing = differences(self_.agreement, theirs)) {
    LinkHeader refuse = header(LinkHeaderType::refuse, Refusal::other_ring_file);
    refuse.sequence = differing;
    return refuse;
  }
  if (refusal == Refusal::none) return {};
  return header(LinkHeaderType::refuse, refusal);
}

LinkHeader Admission::header(LinkHeaderType type, Refusal refusal) const {
  LinkHeader header;
  header.type = type;
  header.ring = self_.ring;
  header.sender = self_.id;
  header.refusal = refusal;
  return header;
}

std::string Admission::label(std::uint8_t node) const {
  const auto at = static_cast<std::size_t>(std::find(order_.begin(), order_.end(), node) - order_.begin());
  return "node " + std::to_string(node) + (at < names_.size() ? " (" + names_[at] + ")" : "");
}

std::size_t Admission::distance(std::uint8_t from) const {
  const auto us = std::find(order_.begin(), order_.end(), self_.id);
  const auto them = std::find(order_.begin(), order_.end(), from);
  if (us == order_.end() || them == order_.end()) return 0;
  const auto step = us - them;
  return static_cast<std::size_t>(step > 0 ? step : step + static_cast<long>(order_.size()));
}

void PendingConnection::wait() {
  socket_.async_wait(event_loop::UnixSocket::wait_read, [self = shared_from_this()](const boost::system::error_code&) {
    if (self->owner_ == nullptr) return;
    self->read();
    if (self->owner_ != nullptr) self->wait();
  });
}

void PendingConnection::read() {
  const auto self = shared_from_this();  // the owner lets go of us in its call
  const auto got = receive_now(socket_.native_handle(), bytes_.data() + size_, wanted_ - size_, descriptors_);
  if (got < 0 && would_block(errno)) return;
  if (got <= 0) return owner_->on_unknown_peer(self, "it left without a word");
  // Each part of a header could bring some more.
  if (descriptors_.size() > kMostDescriptors) return owner_->on_unknown_peer(self, kNoNode);
  size_ += static_cast<std::size_t>(got);
  if (size_ < wanted_) return;
  if (wanted_ == kLinkHeaderSize && take_header()) return read();
  if (open() && wanted_ == kConnectSize)
    owner_->on_greeted(self, header_, load_agreement(bytes_.data() + kLinkHeaderSize));
}

bool PendingConnection::take_header() {
  const auto header = parse_header({bytes_.data(), size_});
  if (!header) {
    owner_->on_unknown_peer(shared_from_this(), kNoNode);
    return false;
  }
  if (header->type != LinkHeaderType::connect && header->type != LinkHeaderType::connect_memory) {
    owner_->on_unknown_peer(shared_from_this(), "it did not ask to connect");
    return false;
  }
  header_ = *header;
  if (header_.version != kLinkVersion) {  // what follows is known to that version alone
    owner_->on_greeted(shared_from_this(), header_, {});
    return false;
  }
  wanted_ = kConnectSize;
  return true;
}

void PendingConnection::close() {
  owner_ = nullptr;
  descriptors_.clear();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

bool PendingConnection::hung_up() { return has_hung_up(socket_.native_handle()); }

void PendingConnection::answer(const LinkHeader& header) {
  const auto bytes = encode(header);
  send_now(socket_.native_handle(), {bytes.data(), bytes.size()});
}

process::UniqueFd PendingConnection::release() {
  owner_ = nullptr;
  boost::system::error_code error;
  return process::UniqueFd(socket_.release(error));
}

}  // namespace limb_ring::link
