#include "limb_ring/payload/reassembler.h"

#include <tuple>

namespace limb_ring::payload {

bool Reassembler::Identity::operator==(const Identity& other) const {
  return std::tie(kind, message, total, checksum) == std::tie(other.kind, other.message, other.total, other.checksum);
}

Reassembler::Identity Reassembler::identity(const Fragment& fragment) {
  return {fragment.kind, fragment.message, fragment.total, fragment.checksum};
}

const Announcement* Reassembler::announcement(std::uint8_t source, std::uint8_t topic) const {
  const auto found = streams_.find({source, topic});
  if (found == streams_.end() || !found->second.announcement) return nullptr;
  return &*found->second.announcement;
}

std::optional<Reassembler::Message> Reassembler::take(std::uint8_t source, ByteView packet) {
  ++packets_;
  const auto fragment = decode_fragment(packet);
  if (!fragment) {
    ++counters_.malformed;
    return std::nullopt;
  }
  const Key key{source, fragment->topic};
  Stream& stream = streams_[key];
  if (is_stale(stream, *fragment)) {
    ++counters_.duplicates;
    return std::nullopt;
  }
  if (starts_afresh(stream, *fragment)) begin(stream, *fragment);
  if (!append(stream, *fragment)) return std::nullopt;
  return finish(key, stream);
}

/// A piece of data older than the message under way: it must not end that one.
bool Reassembler::is_stale(const Stream& stream, const Fragment& fragment) {
  if (!stream.current || fragment.kind != Fragment::Kind::data) return false;
  return static_cast<std::int32_t>(fragment.message - stream.current->message) < 0;
}

/// A sender that restarted announces with the same number and bytes as before: its first piece
/// always counts as a new message.
bool Reassembler::starts_afresh(const Stream& stream, const Fragment& fragment) {
  if (fragment.kind == Fragment::Kind::announcement && fragment.index == 0) return true;
  return !stream.current || !(*stream.current == identity(fragment));
}

void Reassembler::begin(Stream& stream, const Fragment& fragment) {
  if (stream.collecting) drop(stream, counters_.lost);
  stream.current = identity(fragment);
  stream.next = 0;
  stream.collecting = admit(stream, fragment);
  if (!stream.collecting) return;
  held_ += fragment.total;
  stream.bytes.reserve(fragment.total);
}

bool Reassembler::admit(const Stream& stream, const Fragment& fragment) {
  std::uint64_t* reason = nullptr;
  if (fragment.kind == Fragment::Kind::data && !stream.announcement)
    reason = &counters_.unannounced;
  else if (fragment.index != 0)
    reason = &counters_.lost;
  else if (fragment.total > limits_.message)
    reason = &counters_.too_large;
  else if (!make_room(fragment.total))
    reason = &counters_.no_memory;
  if (reason) ++*reason;
  return reason == nullptr;
}

/// A dead source leaves its last message unfinished; such ones give way to living ones.
bool Reassembler::make_room(std::size_t size) {
  if (size > limits_.total) return false;
  while (held_ > limits_.total - size) {
    Stream* idle = longest_idle();
    if (!idle) return false;
    drop(*idle, counters_.evicted);
  }
  return true;
}

Reassembler::Stream* Reassembler::longest_idle() {
  Stream* idle = nullptr;
  for (auto& [key, stream] : streams_)
    if (stream.collecting && (!idle || stream.touched < idle->touched)) idle = &stream;
  return idle;
}

/// @return true where the message is complete now
bool Reassembler::append(Stream& stream, const Fragment& fragment) {
  if (fragment.index < stream.next) {
    ++counters_.duplicates;
    return false;
  }
  if (!stream.collecting) {
    ++counters_.ignored;
    return false;
  }
  if (fragment.index > stream.next) {
    drop(stream, counters_.lost);
    return false;
  }
  stream.bytes.insert(stream.bytes.end(), fragment.bytes.begin(), fragment.bytes.end());
  stream.touched = packets_;
  return ++stream.next == fragment.count;
}

void Reassembler::drop(Stream& stream, std::uint64_t& counter) {
  ++counter;
  stream.collecting = false;
  held_ -= stream.current->total;
  std::vector<std::uint8_t>().swap(stream.bytes);  // gives the memory back
}

std::optional<Reassembler::Message> Reassembler::finish(const Key& key, Stream& stream) {
  Message message{key.first, key.second, stream.current->kind, std::move(stream.bytes)};
  stream.bytes = {};
  stream.collecting = false;
  held_ -= stream.current->total;
  const ByteView bytes{message.bytes.data(), message.bytes.size()};
  if (fnv1a(bytes) != stream.current->checksum ||
      (message.kind == Fragment::Kind::announcement && !keep_announcement(stream, bytes))) {
    ++counters_.corrupt;
    return std::nullopt;
  }
  if (message.kind == Fragment::Kind::announcement)
    message.bytes.clear();
  else
    ++counters_.messages;
  return message;
}

bool Reassembler::keep_announcement(Stream& stream, ByteView bytes) {
  auto announcement = decode_announcement(bytes);
  if (!announcement) return false;
  held_ += bytes.size;
  held_ -= stream.announcement_size;
  stream.announcement_size = bytes.size;
  stream.announcement = std::move(*announcement);
  ++counters_.announcements;
  return true;
}

}  // namespace limb_ring::payload
