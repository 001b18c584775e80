#include <algorithm>
#include <tuple>

#include "client/byte_stream.h"
#include "limb_ring/payload/announcement.h"
#include "limb_ring/payload/fragment.h"
#include "limb_ring/payload/fragmenter.h"
#include "limb_ring/payload/reassembler.h"

namespace limb_ring::payload {
namespace {

/// Bytes that piece `index` of a message of `total` bytes holds.
std::size_t piece_size(const Fragment& fragment) {
  return std::min(kFragmentBytes, fragment.total - std::size_t{fragment.index} * kFragmentBytes);
}

std::optional<DecodeError> check(const Fragment& fragment) {
  if (fragment.total > kMaxMessage) return DecodeError::bad_field;
  if (fragment.count != fragment_count(fragment.total)) return DecodeError::bad_count;
  if (fragment.index >= fragment.count) return DecodeError::bad_field;
  const auto size = piece_size(fragment);
  if (fragment.bytes.size < size) return DecodeError::truncated;
  if (fragment.bytes.size > size) return DecodeError::trailing_bytes;
  return std::nullopt;
}

}  // namespace

std::uint32_t fnv1a(ByteView bytes) {
  std::uint32_t hash = 2166136261U;
  for (std::uint8_t byte : bytes) hash = (hash ^ byte) * 16777619U;
  return hash;
}

std::uint16_t fragment_count(std::size_t total) {
  const std::size_t pieces = (total + kFragmentBytes - 1) / kFragmentBytes;
  return static_cast<std::uint16_t>(std::max<std::size_t>(pieces, 1));
}

std::vector<std::uint8_t> encode(const Fragment& fragment) {
  ByteWriter writer;
  writer.head(PacketType::fragment);
  writer.u8(fragment.topic);
  writer.u8(static_cast<std::uint8_t>(fragment.kind));
  writer.u32(fragment.message);
  writer.u16(fragment.index);
  writer.u16(fragment.count);
  writer.u32(fragment.total);
  writer.u32(fragment.checksum);
  writer.bytes(fragment.bytes);
  return writer.take();
}

Decoded<Fragment> decode_fragment(ByteView packet) {
  ByteReader reader(packet);
  if (const auto wrong = reader.head(PacketType::fragment)) return *wrong;
  Fragment fragment;
  fragment.topic = reader.u8();
  const auto kind = reader.u8();
  fragment.message = reader.u32();
  fragment.index = reader.u16();
  fragment.count = reader.u16();
  fragment.total = reader.u32();
  fragment.checksum = reader.u32();
  if (reader.ended_early()) return DecodeError::truncated;
  if (kind > static_cast<std::uint8_t>(Fragment::Kind::data)) return DecodeError::bad_field;
  fragment.kind = static_cast<Fragment::Kind>(kind);
  fragment.bytes = reader.bytes(reader.left());
  if (const auto wrong = check(fragment)) return *wrong;
  return fragment;
}

bool Fragmenter::start(Fragment::Kind kind, std::vector<std::uint8_t> message) {
  if (message.size() > kMaxMessage) return false;
  kind_ = kind;
  message_ = std::move(message);
  checksum_ = fnv1a({message_.data(), message_.size()});
  count_ = fragment_count(message_.size());
  index_ = 0;
  ++number_;
  return true;
}

std::vector<std::uint8_t> Fragmenter::next() {
  Fragment fragment;
  fragment.kind = kind_;
  fragment.topic = topic_;
  fragment.message = number_;
  fragment.index = index_;
  fragment.count = count_;
  fragment.total = static_cast<std::uint32_t>(message_.size());
  fragment.checksum = checksum_;
  const std::size_t offset = std::size_t{index_} * kFragmentBytes;
  fragment.bytes = {message_.data() + offset, std::min(kFragmentBytes, message_.size() - offset)};
  ++index_;
  return encode(fragment);
}

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

/// @return true if the message is complete now
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

namespace {

constexpr std::uint8_t kLatching = 1;

ByteView view(const std::string& text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

void put_short(ByteWriter& writer, const std::string& text) {
  writer.u16(static_cast<std::uint16_t>(text.size()));
  writer.bytes(view(text));
}

auto tie(const Announcement& a) { return std::tie(a.name, a.datatype, a.md5sum, a.definition, a.latching); }

}  // namespace

bool Announcement::operator==(const Announcement& other) const { return tie(*this) == tie(other); }

Encoded encode(const Announcement& announcement) {
  std::size_t item = 0;
  for (const auto* text : {&announcement.name, &announcement.datatype, &announcement.md5sum}) {
    if (text->size() > 0xFFFF) return EncodeFailure{EncodeError::too_large, item};
    ++item;
  }
  if (announcement.definition.size() > kMaxMessage / 2) return EncodeFailure{EncodeError::too_large, item};
  ByteWriter writer;
  writer.u8(kVersion);
  writer.u8(announcement.latching ? kLatching : std::uint8_t{0});
  put_short(writer, announcement.name);
  put_short(writer, announcement.datatype);
  put_short(writer, announcement.md5sum);
  writer.u32(static_cast<std::uint32_t>(announcement.definition.size()));
  writer.bytes(view(announcement.definition));
  return writer.take();
}

Decoded<Announcement> decode_announcement(ByteView message) {
  ByteReader reader(message);
  const auto version = reader.u8();
  const auto flags = reader.u8();
  if (reader.ended_early()) return DecodeError::truncated;
  if (version != kVersion) return DecodeError::wrong_version;
  if ((flags & ~kLatching) != 0) return DecodeError::bad_field;
  Announcement announcement;
  announcement.latching = flags != 0;
  announcement.name = reader.text(reader.u16());
  announcement.datatype = reader.text(reader.u16());
  announcement.md5sum = reader.text(reader.u16());
  announcement.definition = reader.text(reader.u32());
  if (const auto wrong = reader.finish()) return *wrong;
  // What ROS takes for any type, or for none, cannot be published.
  for (const std::string& text : {announcement.datatype, announcement.md5sum})
    if (text.empty() || text == "*") return DecodeError::bad_field;
  return announcement;
}

}  // namespace limb_ring::payload
