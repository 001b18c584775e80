#include "wire/pcapng_writer.h"

#include "wire/pcapng.h"
#include "wire/pseudo_header.h"

namespace limb_ring::capture {

namespace {

/// One block, little-endian; written as it goes out of scope.
class BlockWriter {
 public:
  BlockWriter(std::ostream& out, pcapng::Block type) : out_(out) {
    u32(type);
    u32(0);  // the length, known in the end
  }
  ~BlockWriter() {
    const std::size_t size = bytes_.size() + 4;
    for (int i = 0; i < 4; ++i) bytes_[4 + i] = static_cast<char>(size >> 8 * i);
    u32(static_cast<std::uint32_t>(size));
    out_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
  }
  BlockWriter(const BlockWriter&) = delete;
  BlockWriter& operator=(const BlockWriter&) = delete;

  BlockWriter& u16(std::uint16_t value) {
    bytes_ += static_cast<char>(value & 0xFF);
    bytes_ += static_cast<char>(value >> 8);
    return *this;
  }
  BlockWriter& u32(std::uint32_t value) {
    return u16(static_cast<std::uint16_t>(value)).u16(static_cast<std::uint16_t>(value >> 16));
  }
  BlockWriter& run(wire::ByteView bytes) {
    bytes_.append(reinterpret_cast<const char*>(bytes.data), bytes.size);
    return *this;
  }
  BlockWriter& pad() {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    return *this;
  }
  BlockWriter& option(pcapng::Option code, const std::string& value) {
    u16(code).u16(static_cast<std::uint16_t>(value.size()));
    bytes_ += value;
    return pad();
  }
  BlockWriter& option_u32(pcapng::Option code, std::uint32_t value) { return u16(code).u16(4).u32(value); }
  BlockWriter& option_u64(pcapng::Option code, std::uint64_t value) {
    return u16(code).u16(8).u32(static_cast<std::uint32_t>(value)).u32(static_cast<std::uint32_t>(value >> 32));
  }
  BlockWriter& end_of_options() { return u32(pcapng::kEnd); }

 private:
  std::ostream& out_;
  std::string bytes_;
};

/// "ring humanoid16; nodes 0=body 1=waist"
std::string comment_of(const RingNames& names) {
  std::string text = "ring " + names.ring + "; nodes";
  for (const auto& [id, name] : names.nodes) text += " " + std::to_string(id) + "=" + name;
  return text;
}

/// Interface, time, lengths, pseudo-header and bytes of an Enhanced Packet; options may follow.
void put_packet(BlockWriter& block, std::uint32_t interface, std::int64_t time_ns, const PseudoHeader& header,
                wire::ByteView bytes) {
  const auto time = static_cast<std::uint64_t>(time_ns);
  const auto size = static_cast<std::uint32_t>(header.size() + bytes.size);
  block.u32(interface).u32(static_cast<std::uint32_t>(time >> 32)).u32(static_cast<std::uint32_t>(time));
  block.u32(size).u32(size).run({header.data(), header.size()}).run(bytes).pad();
}

}  // namespace

std::string RingNames::of(std::uint8_t node) const {
  const auto found = nodes.find(wire::NodeId{node});
  return found == nodes.end() ? std::to_string(node) : found->second;
}

PcapngWriter::PcapngWriter(std::ostream& out, RingNames names) : out_(out), names_(std::move(names)) {
  BlockWriter block(out_, pcapng::kSectionHeader);
  block.u32(pcapng::kByteOrderMagic).u16(1).u16(0);
  block.u32(0xFFFFFFFF).u32(0xFFFFFFFF);  // the section's length is not known
  block.option(pcapng::kComment, comment_of(names_)).option(pcapng::kApplication, "limb_ring").end_of_options();
}

std::uint32_t PcapngWriter::interface_of(const Line& line, const std::string& name) {
  const auto [place, added] = interfaces_.emplace(line, static_cast<std::uint32_t>(interfaces_.size()));
  if (added) {
    BlockWriter block(out_, pcapng::kInterface);
    block.u16(pcapng::kLinkType).u16(0).u32(0);  // no limit of a packet's length
    block.option(pcapng::kInterfaceName, name);
    block.option(pcapng::kResolution, std::string(1, static_cast<char>(pcapng::kNanoseconds))).end_of_options();
  }
  return place->second;
}

void PcapngWriter::packet(std::int64_t time_ns, const CaptureInfo& info, wire::ByteView bytes,
                          std::uint32_t lost_before, const std::string& comment) {
  const std::uint32_t interface =
      interface_of({false, wire::NodeId{info.from}, wire::NodeId{info.to}}, names_.line(info.from, info.to));
  BlockWriter block(out_, pcapng::kEnhancedPacket);
  put_packet(block, interface, time_ns, encode(info), bytes);
  const std::uint32_t direction = info.input ? pcapng::kInbound : pcapng::kOutbound;
  block.option_u32(pcapng::kPacketFlags, direction | (info.crc_bad ? pcapng::kCrcError : 0));
  if (lost_before > 0) block.option_u64(pcapng::kDropCount, lost_before);
  if (!comment.empty()) block.option(pcapng::kComment, comment);
  block.end_of_options();
}

void PcapngWriter::event(std::int64_t time_ns, wire::NodeId node, const std::string& what) {
  const std::uint32_t interface = interface_of({true, node, node}, names_.of(node) + " (events)");
  PseudoHeader header = encode(CaptureInfo{});
  header[1] = kEventFlag;
  header[2] = header[3] = node;
  BlockWriter block(out_, pcapng::kEnhancedPacket);
  put_packet(block, interface, time_ns, header, {});
  block.option(pcapng::kComment, what).end_of_options();
}

}  // namespace limb_ring::capture
