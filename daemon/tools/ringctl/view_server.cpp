#include "tools/ringctl/view.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <deque>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "config/quantity.h"
#include "config/ring_config.h"
#include "io/child.h"
#include "io/program.h"
#include "io/regular_file.h"
#include "limb_ring/ring_directory.h"
#include "ring/ring_files.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;
using nlohmann::json;

namespace {

constexpr std::chrono::seconds kRequestWithin{5};  ///< all of a request
constexpr std::chrono::seconds kAnswerWithin{10};  ///< a client has taken an answer, or one event of a stream
constexpr std::chrono::seconds kOrderWithin{60};   ///< an order of the page
constexpr std::uint32_t kHeaderBytes = 8192;       ///< of a request
constexpr std::uint64_t kBodyBytes = 4096;         ///< of a request
constexpr std::size_t kConnections = 64;           ///< at a time
constexpr std::size_t kStreams = 16;               ///< pages that look, at a time
constexpr int kSystemBytes = 65536;                ///< of that, in the system
constexpr std::size_t kQueuedBytes = 8 << 20;      ///< that wait for one page; more, and it is dropped
constexpr std::size_t kOrders = 4;                 ///< at a time
constexpr std::size_t kOutputBytes = 16384;        ///< of an order, shown
constexpr off_t kLogBytes = 16384;                 ///< of a log, shown: its end
constexpr std::size_t kWords = 6, kWordSize = 64;  ///< of an order

using Text = std::shared_ptr<const std::string>;
using HttpRequest = http::request<http::string_body>;
using Respond = std::function<void(http::status, std::string type, std::string body)>;

struct PageFile {
  const char* name;
  const char* type;
};
constexpr PageFile kPage[] = {
    {"index.html", "text/html; charset=utf-8"},      {"style.css", "text/css; charset=utf-8"},
    {"view.mjs", "text/javascript; charset=utf-8"},  {"ring.mjs", "text/javascript; charset=utf-8"},
    {"model.mjs", "text/javascript; charset=utf-8"}, {"graphs.mjs", "text/javascript; charset=utf-8"},
    {"source.mjs", "text/javascript; charset=utf-8"}};

/// By name; only these can be asked for. @throw UsageError
std::map<std::string, std::string> read_page(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const PageFile& file : kPage) {
    const std::string path = folder + "/" + file.name;
    std::ifstream in(path, std::ios::binary);
    if (!in) throw UsageError(path + ": the page is not there; it is installed with limb_ring, as share/limb_ring/web");
    files[file.name] = std::string(std::istreambuf_iterator<char>(in), {});
  }
  return files;
}

std::string new_token() {
  std::random_device random;
  std::ostringstream text;
  text << std::hex << std::setfill('0');
  for (int i = 0; i < 4; ++i) text << std::setw(8) << random();
  return text.str();
}

/// The last lines of what a node's daemon and its CPU printed, or why they are not kept; nothing if `id` is none.
std::optional<std::string> end_of_log(const std::string& ring, const std::string& id) {
  if (!config::are_digits(id, 3) || std::stoi(id) > 254) return {};
  const std::string path = live::log_of(ring_directory(ring), static_cast<std::uint8_t>(std::stoi(id)));
  const process::UniqueFd file = path.empty() ? process::UniqueFd() : process::open_regular(path);
  if (!file.valid())
    return "No log is kept here: the node is not on this host, or not started by 'ringctl up --detach'.";
  const off_t size = ::lseek(file.get(), 0, SEEK_END), from = std::max<off_t>(0, size - kLogBytes);
  std::string text(static_cast<std::size_t>(kLogBytes), '\0');
  const ssize_t got = ::pread(file.get(), text.data(), text.size(), from);
  text.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return from == 0 ? text : text.substr(text.find('\n') + 1);
}

std::string server_event(const std::string& event, const std::string& data) {
  return "event: " + event + "\ndata: " + data + "\n\n";
}

/// What the page may order: first words, and second ones if these are not free.
const std::map<std::string, std::set<std::string>>& possible_orders() {
  static const std::map<std::string, std::set<std::string>> all{
      {"fault", {"cut", "heal", "hang", "resume", "crash", "freeze", "thaw", "kill", "start", "clear"}},
      {"clock", {"pause", "run", "step", "pace"}},
      {"reset", {}},
      {"stop", {}},
      {"resume", {}}};
  return all;
}

bool is_plain_word(const std::string& word) {
  constexpr std::string_view kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.:";
  return !word.empty() && word.size() <= kWordSize && word.front() != '-' &&
         word.find_first_not_of(kPlain) == std::string::npos;
}

/// What a ringctl prints that does what the page has ordered.
class Order {
 public:
  using Done = std::function<void(int code, std::string output)>;

  Order(asio::io_context& io, const std::string& ring, const std::vector<std::string>& words, Done done)
      : child_(io), deadline_(io), done_(std::move(done)) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) throw std::runtime_error("too many open files");
    output_.reset(ends[0]);
    const process::UniqueFd into(ends[1]);
    process::SpawnRequest request;
    request.path = process::own_folder() + "/ringctl";
    request.arguments = {"ringctl", "--ring", ring};
    request.arguments.insert(request.arguments.end(), words.begin(), words.end());
    request.output = into.get();
    child_.start(request, [this](const process::ExitStatus& status) { ended(status); });
    deadline_.expires_after(kOrderWithin);
    deadline_.async_wait([this](const error_code& problem) {
      if (!problem) child_.signal_group(SIGKILL);
    });
  }

 private:
  void ended(const process::ExitStatus& status) {
    deadline_.cancel();
    std::string text(kOutputBytes, '\0');
    const ssize_t size = ::read(output_.get(), text.data(), text.size());
    text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    if (!status.code) text += status.text;
    done_(status.code.value_or(kUnknown), text);
  }

  process::ChildProcess child_;
  asio::steady_timer deadline_;
  process::UniqueFd output_;
  Done done_;
};

/// A page that looks: events, one after the other, until it goes or is too slow.
class Stream : public std::enable_shared_from_this<Stream> {
 public:
  Stream(beast::tcp_stream socket, std::function<void(const std::shared_ptr<Stream>&)> gone)
      : socket_(std::move(socket)), gone_(std::move(gone)) {}

  void start(const std::vector<Text>& first) {
    error_code ignored;
    socket_.socket().set_option(asio::socket_base::send_buffer_size(kSystemBytes), ignored);
    static const Text head = std::make_shared<const std::string>(
        "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\nConnection: close\r\n"
        "X-Content-Type-Options: nosniff\r\n\r\nretry: 1000\n\n");
    put(head);
    for (const Text& text : first) put(text);
    watch();
  }

  void put(const Text& text) {
    if (ended_) return;
    queued_ += text->size();
    if (queued_ > kQueuedBytes) return end();
    queue_.push_back(text);
    if (queue_.size() == 1) write();
  }

  void end() {
    if (std::exchange(ended_, true)) return;
    socket_.close();
    asio::post(socket_.get_executor(), [self = shared_from_this()] { self->gone_(self); });
  }

 private:
  void write() {
    socket_.expires_after(kAnswerWithin);
    asio::async_write(socket_, asio::buffer(*queue_.front()),
                      [self = shared_from_this()](const error_code& problem, std::size_t) {
                        if (problem) return self->end();
                        self->queued_ -= self->queue_.front()->size();
                        self->queue_.pop_front();
                        if (!self->queue_.empty() && !self->ended_) self->write();
                      });
  }

  /// A page says nothing more: what comes is its end.
  void watch() {
    socket_.socket().async_wait(tcp::socket::wait_read,
                                [self = shared_from_this()](const error_code&) { self->end(); });
  }

  beast::tcp_stream socket_;
  std::function<void(const std::shared_ptr<Stream>&)> gone_;
  std::deque<Text> queue_;
  std::size_t queued_ = 0;
  bool ended_ = false;
};

class Server;

/// One connection: one request and its answer, or a stream.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, Server& server);
  ~Connection() { --*count_; }
  void start();

 private:
  void answer(http::status status, const std::string& type, std::string body);

  beast::tcp_stream socket_;
  Server& server_;
  const std::shared_ptr<std::size_t> count_;
  beast::flat_buffer buffer_{kHeaderBytes + kBodyBytes};
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> response_;
};

class Server {
 public:
  Server(asio::io_context& io, const ViewOptions& options)
      : io_(io),
        options_(options),
        page_(read_page(options.folder)),
        token_(new_token()),
        acceptor_(io),
        ring_(options.ring) {
    listen();
    told_.assign(ring_.told_fd());
    take();
    accept();
  }
  ~Server() { told_.release(); }

  std::string address() const {
    const tcp::endpoint at = acceptor_.local_endpoint();
    const std::string host = at.address().is_v6() ? "[" + at.address().to_string() + "]" : at.address().to_string();
    return "http://" + host + ":" + std::to_string(at.port()) + "/" + token_ + "/";
  }
  bool is_loopback() const { return acceptor_.local_endpoint().address().is_loopback(); }

  /// How many there are; they outlive this.
  const std::shared_ptr<std::size_t> connections = std::make_shared<std::size_t>(0);

  /// @param stream takes the connection over, where the request is for one
  void handle(const HttpRequest& request, const Respond& answer, const std::function<void()>& stream) {
    const auto refuse = [&answer](http::status status, const std::string& why) {
      answer(status, "text/plain", why + "\n");
    };
    const std::string host(request[http::field::host]), origin(request[http::field::origin]);
    if (!is_own_host(host, port_)) return refuse(http::status::forbidden, "not for this host");
    if (request.count(http::field::origin) != 0 && origin != "http://" + host)
      return refuse(http::status::forbidden, "not for pages of another origin");
    const std::string target(request.target());
    const std::size_t slash = std::min(target.find('/', 1), target.size());
    if (target.size() < 2 || target[0] != '/' || !is_same_secret(target.substr(1, slash - 1), token_))
      return refuse(http::status::forbidden, "open the whole address that 'ringctl view' has printed");
    if (slash == target.size()) return refuse(http::status::not_found, "the address ends with a slash");
    const std::string path = target.substr(slash + 1);
    if (request.method() == http::verb::post && path == "order") return order(request, answer);
    if (request.method() != http::verb::get) return refuse(http::status::method_not_allowed, "GET, or POST order");
    if (path == "events") {
      if (streams_.size() >= kStreams)
        return refuse(http::status::service_unavailable, std::to_string(kStreams) + " pages look already");
      return stream();
    }
    const std::string node = "node/";
    if (path.rfind(node, 0) == 0) {
      const std::string row = ring_.row(path.substr(node.size()));
      return row.empty() ? refuse(http::status::not_found, "no such node, or nothing is known of it")
                         : answer(http::status::ok, "application/json", row);
    }
    const std::string log = "log/";
    if (path.rfind(log, 0) == 0) {
      const std::optional<std::string> text = end_of_log(options_.ring, path.substr(log.size()));
      return text ? answer(http::status::ok, "text/plain; charset=utf-8", *text)
                  : refuse(http::status::not_found, "a log is that of a node's id");
    }
    for (const PageFile& file : kPage)
      if (path == file.name || (path.empty() && &file == kPage))
        return answer(http::status::ok, file.type, page_.at(file.name));
    refuse(http::status::not_found, "no such page");
  }

  void add_stream(beast::tcp_stream socket) {
    const auto stream = std::make_shared<Stream>(std::move(socket), [this](const auto& gone) { remove(gone); });
    streams_.insert(stream);
    std::vector<Text> first{
        std::make_shared<const std::string>(server_event("view", json{{"control", options_.control}}.dump()))};
    for (const auto& [event, text] : newest_) first.push_back(text);
    stream->start(first);
    ring_.look(true);
  }

 private:
  void listen() {
    error_code problem;
    const auto address = asio::ip::make_address(options_.address, problem);
    if (problem)
      throw UsageError("--address " + options_.address + ": not an address in numbers; one is 127.0.0.1 or ::1");
    const tcp::endpoint at(address, options_.port);
    acceptor_.open(at.protocol());
    acceptor_.set_option(tcp::acceptor::reuse_address(true));
    acceptor_.bind(at, problem);
    if (!problem) acceptor_.listen(kConnections, problem);
    if (problem)
      throw UsageError("--address " + options_.address + " --port " + std::to_string(options_.port) + ": " +
                       problem.message() + "; without --port any free one is taken");
    port_ = acceptor_.local_endpoint().port();
  }

  void accept() {
    acceptor_.async_accept([this](const error_code& problem, tcp::socket socket) {
      if (problem == asio::error::operation_aborted) return;
      if (!problem && *connections < kConnections) std::make_shared<Connection>(std::move(socket), *this)->start();
      if (!problem) return accept();
      // Too few descriptors: one may be free soon.
      accept_again_.expires_after(std::chrono::milliseconds(100));
      accept_again_.async_wait([this](const error_code& ends) {
        if (!ends) accept();
      });
    });
  }

  /// What the thread that asks the ring has told. asio is built without threads here (BOOST_ASIO_DISABLE_THREADS):
  /// nothing of it may be called from another one.
  void take() {
    told_.async_wait(asio::posix::stream_descriptor::wait_read, [this](const error_code& problem) {
      if (problem) return;
      ring_.take([this](const std::string& event, const std::string& text) { tell(event, text); });
      take();
    });
  }

  void tell(const std::string& event, const std::string& text) {
    const auto message = std::make_shared<const std::string>(server_event(event, text));
    if (event == "ring" || event == "status") newest_[event] = message;
    const auto streams = streams_;  // one that ends takes itself out
    for (const auto& stream : streams) stream->put(message);
  }

  void remove(const std::shared_ptr<Stream>& stream) {
    streams_.erase(stream);
    if (!streams_.empty()) return;
    ring_.look(false);
    newest_.erase("status");  // the ring itself is told once, and is as it was
  }

  void order(const HttpRequest& request, const Respond& answer) {
    const auto refuse = [&answer](http::status status, const std::string& why) {
      answer(status, "text/plain", why + "\n");
    };
    if (!options_.control)
      return refuse(http::status::forbidden, "read-only; 'ringctl view --control' lets the page do that");
    if (request[http::field::content_type] != "application/json")
      return refuse(http::status::unsupported_media_type, "an order is application/json");
    if (orders_.size() >= kOrders)
      return refuse(http::status::service_unavailable, "other orders are being carried out");
    std::vector<std::string> words;
    try {
      words = ordered_words(request.body());
    } catch (const UsageError& problem) {
      return refuse(http::status::bad_request, problem.what());
    }
    carry_out(words, answer);
  }

  void carry_out(const std::vector<std::string>& words, const Respond& answer) {
    const std::string command = "ringctl " + config::join(words, " ");
    const auto done = [this, command, answer, id = next_order_](int code, const std::string& output) {
      const json said{{"command", command}, {"code", code}, {"text", output}};
      const std::string text = said.dump(-1, ' ', false, json::error_handler_t::replace);
      tell("ordered", text);
      answer(http::status::ok, "application/json", text);
      asio::post(io_, [this, id] { orders_.erase(id); });  // it is what calls this
    };
    try {
      orders_[next_order_++] = std::make_unique<Order>(io_, options_.ring, words, done);
    } catch (const std::runtime_error& problem) {
      orders_.erase(next_order_ - 1);
      answer(http::status::service_unavailable, "text/plain", problem.what());
    }
  }

  asio::io_context& io_;
  const ViewOptions& options_;
  const std::map<std::string, std::string> page_;
  const std::string token_;
  tcp::acceptor acceptor_;
  asio::steady_timer accept_again_{io_};
  std::uint16_t port_ = 0;
  std::set<std::shared_ptr<Stream>> streams_;
  std::map<std::string, Text> newest_;  ///< what a page is told first
  std::map<unsigned, std::unique_ptr<Order>> orders_;
  unsigned next_order_ = 0;
  ViewedRing ring_;
  asio::posix::stream_descriptor told_{io_};
};

Connection::Connection(tcp::socket socket, Server& server)
    : socket_(std::move(socket)), server_(server), count_(server.connections) {
  ++*count_;
  parser_.header_limit(kHeaderBytes);
  parser_.body_limit(kBodyBytes);
}

void Connection::start() {
  socket_.expires_after(kRequestWithin);
  http::async_read(socket_, buffer_, parser_, [self = shared_from_this()](const error_code& problem, std::size_t) {
    if (problem == http::error::body_limit)
      return self->answer(http::status::payload_too_large, "text/plain", "too large\n");
    if (problem == http::error::header_limit || problem == http::error::buffer_overflow)
      return self->answer(http::status::request_header_fields_too_large, "text/plain", "too large\n");
    if (problem && problem.category() == make_error_code(http::error::bad_value).category() &&
        problem != http::error::end_of_stream && problem != http::error::partial_message)
      return self->answer(http::status::bad_request, "text/plain", "not HTTP\n");
    if (problem) return;
    self->server_.handle(
        self->parser_.get(),
        [self](http::status status, const std::string& type, std::string body) {
          self->answer(status, type, std::move(body));
        },
        [self] { self->server_.add_stream(std::move(self->socket_)); });
  });
}

void Connection::answer(http::status status, const std::string& type, std::string body) {
  response_.result(status);
  response_.version(11);
  response_.keep_alive(false);
  response_.set(http::field::content_type, type);
  response_.set(http::field::cache_control, "no-store");
  response_.set(
      "Content-Security-Policy",
      "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'");
  response_.set("Cross-Origin-Resource-Policy", "same-origin");
  response_.set("Referrer-Policy", "no-referrer");
  response_.set("X-Content-Type-Options", "nosniff");
  response_.body() = std::move(body);
  response_.prepare_payload();
  socket_.expires_after(kAnswerWithin);
  http::async_write(socket_, response_, [self = shared_from_this()](const error_code&, std::size_t) {
    error_code ignored;
    self->socket_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  });
}

}  // namespace

bool is_same_secret(const std::string& one, const std::string& other) {
  unsigned differs = one.size() == other.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(one.size(), other.size()); ++i)
    differs |= static_cast<unsigned char>(one[i]) ^ static_cast<unsigned char>(other[i]);
  return differs == 0;
}

bool is_own_host(const std::string& host, std::uint16_t port) {
  const std::size_t colon = host.rfind(':');
  if (colon == std::string::npos || host.substr(colon + 1) != std::to_string(port)) return false;
  std::string name = host.substr(0, colon);
  if (name == "localhost") return true;
  if (name.size() > 2 && name.front() == '[' && name.back() == ']') name = name.substr(1, name.size() - 2);
  error_code problem;
  asio::ip::make_address(name, problem);
  return !problem;
}

std::vector<std::string> ordered_words(const std::string& text) {
  const json order = json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!order.is_array() || order.empty() || order.size() > kWords)
    throw UsageError("an order is an array of 1 to " + std::to_string(kWords) +
                     R"( words, as ["fault", "hang", "left_knee"])");
  std::vector<std::string> words;
  for (const json& word : order) {
    if (!word.is_string() || !is_plain_word(word.get<std::string>()))
      throw UsageError("a word of an order is made of letters, digits, '_', '-', '.' and ':', and begins with no '-'");
    words.push_back(word.get<std::string>());
  }
  const auto found = possible_orders().find(words[0]);
  const bool second = found != possible_orders().end() && !found->second.empty();
  if (found == possible_orders().end() || (second && (words.size() < 2 || found->second.count(words[1]) == 0)))
    throw UsageError(words[0] + (second && words.size() > 1 ? " " + words[1] : "") + ": the page may not order that");
  return words;
}

int serve_view(const ViewOptions& options) {
  asio::io_context io;
  asio::signal_set signals(io, SIGINT, SIGTERM, SIGHUP);
  signals.async_wait([&io](const error_code&, int) { io.stop(); });
  Server server(io, options);
  std::cout << "ring " << options.ring << " in a browser: " << server.address() << '\n'
            << (options.control ? "Whoever has this address may break and mend the ring."
                                : "Read-only; --control lets the page break and mend.")
            << " Ctrl-C ends it." << std::endl;
  if (!server.is_loopback())
    tell_user("not encrypted: whoever sees the traffic between browser and this host sees the token");
  io.run();
  return kDone;
}

}  // namespace limb_ring::ringctl
