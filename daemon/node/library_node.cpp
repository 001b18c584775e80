#include "node/library_node.h"

#include <dlfcn.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <stdexcept>

#include "io/unique_fd.h"
#include "node/link_settings.h"
#include "node/steering.h"

namespace limb_ring::virtual_host {

using link::LinkHeader;
using link::LinkHeaderType;
using wire::ByteView;
using wire::NodeId;

namespace {

/// The library knows an asking end of its neighbour by a number, a listening one by the node's id.
constexpr std::uint32_t kAsks = 0x100;
constexpr core::Duration kMillisecond = std::chrono::milliseconds(1);

using Send = void (*)(std::uint32_t to, const std::uint8_t* bytes, std::size_t size);
using Begin = void (*)(const char* ring, std::uint8_t id, const std::uint8_t* order, std::uint8_t count,
                       const std::uint8_t* agreement, std::uint64_t boot, std::uint32_t now, Send send);
using Came = void (*)(std::uint32_t now, std::uint32_t from, const std::uint8_t* bytes, std::size_t size);
using Passed = void (*)(std::uint32_t now);

/// Who calls a library now: it sends only then, and without saying who it is.
std::function<void(std::uint32_t to, ByteView datagram)>* sends_to = nullptr;

void send_datagram(std::uint32_t to, const std::uint8_t* bytes, std::size_t size) { (*sends_to)(to, {bytes, size}); }

/// A copy, since a library that is opened twice is there once.
process::UniqueFd copy_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  process::UniqueFd copy(::memfd_create("node", MFD_CLOEXEC));
  if (!copy.valid() || ::write(copy.get(), bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error(path + ": no memory for a copy of it");
  return copy;
}

}  // namespace

struct LibraryNode::Code {
  explicit Code(const std::string& path) : copy(copy_of(path)) {
    handle.reset(::dlopen(("/proc/self/fd/" + std::to_string(copy.get())).c_str(), RTLD_NOW | RTLD_LOCAL));
    if (!handle) throw std::runtime_error(path + " is not a shared library for this machine: " + ::dlerror());
    find(path, "library_node_begin", begin);
    find(path, "library_node_came", came);
    find(path, "library_node_passed", passed);
  }
  template <class Function>
  void find(const std::string& path, const char* name, Function& function) {
    function = reinterpret_cast<Function>(::dlsym(handle.get(), name));
    if (function == nullptr)
      throw std::runtime_error(path + " has no function " + name +
                               "(): a node has three (library_node.c of tiny_node)");
  }
  struct Close {
    void operator()(void* library) const { ::dlclose(library); }
  };
  process::UniqueFd copy;  ///< open for as long: by its path, which has its number, it is told from others
  std::unique_ptr<void, Close> handle;
  Begin begin = nullptr;
  Came came = nullptr;
  Passed passed = nullptr;
};

/// The listening end of the line out of it.
struct LibraryNode::FarEnd final : private link::InputLine, private link::InputHandler {
  FarEnd(LibraryNode& in, NodeId of)
      : node(in),
        id(of),
        input({in.identity(of), {}, setup::order_on(in.config_, core::Line::first), in.timing_}, *this, *this, report,
              upstream, [this](ByteView datagram, const link::UdpAddress&) { node.tell(id, datagram); }) {}

  void close() override { input.close(); }
  std::optional<std::uint8_t> from() const override { return input.from(); }
  void replace(std::uint8_t by) override { input.replace(by); }
  void on_slice(const wire::Slice& slice) override { node.out_.put(slice.kind, slice.bytes); }
  void on_batch_end() override {}
  void on_input_gap() override { node.ring_.guest_gap(node.id_); }
  void on_input_up(std::uint8_t) override { node.ring_.guest_connected(node.id_); }
  void on_input_lost(std::string_view reason) override { node.lost(reason); }
  void on_unknown_peer(std::string_view reason) override {
    spdlog::warn("{}: node {} refuses its line: {}", node.node_.name, +id, reason);
  }

  LibraryNode& node;
  NodeId id;
  link::InputReport report;
  link::Upstream upstream;
  link::DatagramInput input;
};

LibraryNode::LibraryNode(sim::VirtualRing& ring, const config::RingConfig& config, const config::NodeConfig& node)
    : ring_(ring),
      config_(config),
      node_(node),
      id_(node.id),
      timing_(setup::timing_of(config)),
      agreement_(setup::agreement_of(config)) {
  ring_.kill(id_);
  ring_.set_guest(id_, *this);
}

LibraryNode::~LibraryNode() = default;

void LibraryNode::switch_on() {
  code_ = std::make_unique<Code>(node_.library);
  running_ = std::make_shared<LibraryNode*>(this);
  const std::vector<std::uint8_t> order = setup::order_on(config_, core::Line::first);
  std::array<std::uint8_t, link::kAgreementSize> agreement;
  link::store_agreement(agreement.data(), agreement_);
  ++starts_;
  const std::uint64_t boot = starts_ << 32 | std::uint64_t{id_} << 24 | wire::incarnation_of(starts_);
  call([&] {
    code_->begin(config_.ring.c_str(), id_, order.data(), static_cast<std::uint8_t>(order.size()), agreement.data(),
                 boot, milliseconds(), send_datagram);
  });
  wake_at(ring_.now() + kMillisecond);
}

void LibraryNode::switch_off() {
  running_.reset();
  ring_.kill(id_);
  code_.reset();
  inbox_.clear();
  out_.clear();
}

void LibraryNode::freeze() {
  running_.reset();
  ring_.kill(id_);
}

void LibraryNode::thaw() {
  running_ = std::make_shared<LibraryNode*>(this);
  wake_at(ring_.now() + kMillisecond);
}

// ---- time -----------------------------------------------------------------------------------

void LibraryNode::wake_at(core::Time when) {
  ring_.at(when, [weak = std::weak_ptr<LibraryNode*>(running_)] {
    if (const auto self = weak.lock()) (*self)->turn();
  });
}

void LibraryNode::turn() {
  for (const auto& [from, datagram] : std::exchange(inbox_, {}))
    call([&, from = from, &datagram = datagram] {
      code_->came(milliseconds(), from, datagram.data(), datagram.size());
    });
  call([&] { code_->passed(milliseconds()); });
  if (milliseconds() % static_cast<std::uint32_t>(timing_.idle.count()) == 0) keep_lines();
  if (before_ && !before_->accepted && milliseconds() % static_cast<std::uint32_t>(timing_.retry.count()) == 0) ask();
  if (std::exchange(lost_, false)) ring_.kill(id_);
  if (ring_.alive(id_)) ring_.node(id_);  // what it gives out leaves now
  wake_at(ring_.now() + kMillisecond);
}

/// Each end says that it lives, and judges whether the other one does.
void LibraryNode::keep_lines() {
  if (before_ && before_->accepted) {
    wire::SliceWriter idle;
    idle.put(wire::SliceKind::idle, {});
    send_slices(idle.view());
    if (before_->silence.tick(link_time())) lost("it has stopped saying that it takes what comes in");
  }
  if (after_ && after_->input.tick(link_time())) after_->input.lose_if_silent();
}

std::uint32_t LibraryNode::milliseconds() const {
  return static_cast<std::uint32_t>(
      std::chrono::floor<std::chrono::milliseconds>(ring_.now().time_since_epoch()).count());
}

link::Time LibraryNode::link_time() const { return VirtualClock::at(ring_.now()); }

// ---- who is beside it -----------------------------------------------------------------------

link::Identity LibraryNode::identity(NodeId id) const { return {link::ring_hash(config_.ring), id, agreement_}; }

void LibraryNode::wired_from(NodeId from) {
  before_ = std::make_unique<NearEnd>(NearEnd{from, ++asked_ << 32, false, 0, link::Silence(timing_)});
  ask();
}

void LibraryNode::wired_to(NodeId to) {
  if (!after_ || after_->id != to)
    after_ = std::make_unique<FarEnd>(*this, to);
  else if (after_->input.from())
    ring_.guest_connected(id_);  // the wire was cut, and neither end has lost the other
}

void LibraryNode::output_gone() {
  after_.reset();
  out_.clear();
}

/// The ring closes without it, once its turn is over. It may connect again.
void LibraryNode::lost(std::string_view reason) {
  if (!std::exchange(lost_, true)) spdlog::warn("{}: its line is lost: {}", node_.name, reason);
}

// ---- datagrams ------------------------------------------------------------------------------

template <class Call>
void LibraryNode::call(Call function) {
  std::function<void(std::uint32_t, ByteView)> send = [this](std::uint32_t to, ByteView datagram) {
    sent(to, datagram);
  };
  sends_to = &send;
  function();
  sends_to = nullptr;
}

void LibraryNode::sent(std::uint32_t to, ByteView datagram) {
  const auto header = link::parse_header(datagram);
  if (to >= kAsks) {
    if (header && before_ && to == kAsks + before_->id) take_of_input(*header);
    return;
  }
  if (!ring_.alive(id_) && !lost_ && header && link::asks_to_connect(header->type)) ring_.start(id_);
  if (after_ && to == after_->id) after_->input.take(datagram, {}, link_time());
}

void LibraryNode::take_of_input(const LinkHeader& header) {
  before_->silence.heard();
  const bool ours = link::session_nonce(header.session) == link::session_nonce(before_->session);
  if (header.type == LinkHeaderType::accept && ours && !before_->accepted) {
    before_->session = header.session;
    before_->accepted = true;
    before_->silence.restart(link_time());
    ring_.guest_accepts(id_);
  } else if (header.type == LinkHeaderType::refuse && before_->accepted) {
    lost(link::reason_of(header));
  }
}

/// Of the node before it.
LinkHeader LibraryNode::header(LinkHeaderType type) const {
  LinkHeader header;
  header.type = type;
  header.ring = link::ring_hash(config_.ring);
  header.session = before_->session;
  header.sender = before_->id;
  return header;
}

void LibraryNode::ask() {
  const auto bytes = link::encode_connect(header(LinkHeaderType::connect), agreement_);
  tell(kAsks + before_->id, {bytes.data(), bytes.size()});
}

void LibraryNode::tell(std::uint32_t from, ByteView datagram) {
  inbox_.emplace_back(from, std::vector<std::uint8_t>(datagram.begin(), datagram.end()));
}

void LibraryNode::receive(const wire::Slice& slice, core::Time) {
  if (code_ == nullptr || !before_ || !before_->accepted) return;
  wire::SliceWriter framed;
  framed.put(slice.kind, slice.bytes);
  send_slices(framed.view());
}

void LibraryNode::send_slices(ByteView slices) {
  LinkHeader slices_of = header(LinkHeaderType::slices);
  slices_of.sequence = ++before_->sequence;
  const auto bytes = link::encode(slices_of);
  std::vector<std::uint8_t> datagram(bytes.begin(), bytes.end());
  datagram.insert(datagram.end(), slices.begin(), slices.end());
  call([&] { code_->came(milliseconds(), kAsks + before_->id, datagram.data(), datagram.size()); });
}

}  // namespace limb_ring::virtual_host
