#include "orchestrator/live/server/socket.h"  // first: Asio needs <utility>, and does not include it

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cerrno>
#include <cstring>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>

#include "orchestrator/live/server/origin.h"
#include "orchestrator/live/server/outgoing.h"
#include "system/failure.h"
#include "system/local_socket.h"

namespace mascot {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using HttpRequest = http::request<http::empty_body>;
using Response = http::response<http::string_body>;

constexpr int kPortsToTry = 100;
constexpr int kMaxLines = 100;  // of the log: a hostile client could fill a disk
constexpr auto kGoodbyeLook = std::chrono::milliseconds(5);
constexpr auto kFullPause = std::chrono::milliseconds(10);  // until a client is let in, without descriptors
constexpr auto kIdle = std::chrono::seconds(60);            // a client that does not even answer pings is gone
/// The kernel's share of what waits for a client: small, so that a slow client is noticed and sees no old frames.
constexpr int kSendBuffer_bytes = 256 << 10;

std::string_view View(beast::string_view text) { return {text.data(), text.size()}; }

class Session;

/// What a connection needs of the server.
struct Server {
  SocketOptions options;
  SocketUser& user;
  std::function<void(const std::string&)> log;
  OriginCheck origin_check;
  std::map<ClientId, Session*> sessions = {};  // those that are open
  std::set<beast::tcp_stream*> streams = {};   // of all connections
  RefusalCount refusals = {};
  std::size_t connections = 0, by_websocket = 0;  // of both kinds; by WebSocket, also those that are being closed
  OutgoingMemory waiting = {};
  ClientId last_id = 0;
  int lines = 0;
  bool ending = false;
  asio::io_context io{1};  // last: what it still holds at the end uses the rest

  void Log(const std::string& line) {
    if (lines > kMaxLines) return;
    log(++lines > kMaxLines ? "viewers: too many were dropped; no more lines about them" : line);
  }
  /// Logs which client was not let in, and why.
  void LogRefusal(const std::string& name, const std::string& words) {
    if (const auto line = refusals.Line(words)) log(name + ": refused: " + *line);
  }
};

std::string NameOf(const tcp::socket& socket) {
  error_code gone;
  const tcp::endpoint peer = socket.remote_endpoint(gone);
  return "viewer " + (gone ? "?" : peer.address().to_string() + ":" + std::to_string(peer.port()));
}

/// A connection by WebSocket. It lives as long as one of its operations is going on.
class Session : public std::enable_shared_from_this<Session> {
 public:
  Session(Server& server, tcp::socket socket)
      : server_(server), id_(++server.last_id), name_(NameOf(socket)), stream_(std::move(socket)) {
    ++server_.connections;
    ++server_.by_websocket;
    server_.streams.insert(&beast::get_lowest_layer(stream_));
  }
  ~Session() {
    while (!out_.empty()) TakeOut(out_.begin());
    server_.streams.erase(&beast::get_lowest_layer(stream_));
    --server_.connections;
    --server_.by_websocket;
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void Accept(const HttpRequest& request, const std::string& subprotocol) {
    server_.sessions[id_] = this;
    stream_.set_option(websocket::stream_base::timeout{
        .handshake_timeout = server_.options.limits.handshake, .idle_timeout = kIdle, .keep_alive_pings = true});
    stream_.set_option(websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
      response.set(http::field::sec_websocket_protocol, subprotocol);
    }));
    stream_.auto_fragment(false);  // a message is one frame: it is in memory anyway
    stream_.read_message_max(server_.options.limits.message_bytes);
    stream_.async_accept(request,
                         [self = shared_from_this(), subprotocol, target = std::string(View(request.target()))](
                             error_code error) { self->OnAccept(error, subprotocol, target); });
  }

  void Send(Frame frame) {
    if (!open_) return;
    waiting_bytes_ += SizeOf(frame);
    server_.waiting.Add(frame);
    out_.push_back(std::move(frame));
    if (waiting_bytes_ > server_.options.limits.waiting_bytes) return Drop("does not read what it asks for");
    if (out_.size() == 1) Write();
    if (server_.waiting.bytes() > server_.options.limits.all_waiting_bytes) DropSlowest();
  }
  std::size_t waiting() const { return waiting_bytes_; }
  /// Closes the connection once everything is sent.
  void SayGoodbye() {
    goodbye_ = true;
    if (out_.empty()) Close(websocket::close_code::going_away, "");
  }

 private:
  static std::size_t SizeOf(const Frame& frame) { return frame.head.size() + (frame.body ? frame.body->size() : 0); }

  void OnAccept(error_code error, const std::string& subprotocol, const std::string& target) {
    if (error) return Forget();
    open_ = true;
    told_ = true;
    Guard([&] { server_.user.OnOpen(id_, subprotocol, target); });
    if (server_.ending) SayGoodbye();
    Read();
  }

  void Read() {
    stream_.async_read(in_, [self = shared_from_this()](error_code error, std::size_t) { self->OnRead(error); });
  }

  void OnRead(error_code error) {
    if (error) {
      if (error == websocket::condition::protocol_violation || error == websocket::error::message_too_big ||
          error == websocket::error::buffer_overflow)
        server_.Log(name_ + ": dropped: " + error.message());
      return Forget();
    }
    if (open_) {
      std::string why;
      Guard([&] {
        why = server_.user.OnMessage(id_, stream_.got_text(),
                                     {static_cast<const std::uint8_t*>(in_.data().data()), in_.data().size()});
      });
      if (!why.empty()) Drop(why);
    }
    in_.consume(in_.size());
    Read();  // also when it is closing: until the client has closed too
  }

  void Write() {
    const Frame& frame = out_.front();
    stream_.text(frame.is_text);
    const std::array<asio::const_buffer, 2> parts{asio::buffer(frame.head),
                                                  frame.body ? asio::buffer(*frame.body) : asio::const_buffer()};
    stream_.async_write(parts, [self = shared_from_this()](error_code error, std::size_t) { self->OnWritten(error); });
  }

  void OnWritten(error_code error) {
    if (error) return Forget();
    TakeOut(out_.begin());
    if (!out_.empty() && open_) return Write();
    if (goodbye_) Close(websocket::close_code::going_away, "");
  }

  void TakeOut(std::deque<Frame>::iterator frame) {
    waiting_bytes_ -= SizeOf(*frame);
    server_.waiting.Remove(*frame);
    out_.erase(frame);
  }

  void DropSlowest() {
    const auto slowest =
        std::ranges::max_element(server_.sessions, {}, [](const auto& open) { return open.second->waiting_bytes_; });
    slowest->second->Drop("the viewers do not read what they ask for, and this one leaves most of it");
  }

  void Drop(const std::string& why) {
    server_.Log(name_ + ": dropped: " + why);
    Close(websocket::close_code::policy_error, why);
  }

  void Close(websocket::close_code code, const std::string& why) {
    if (!open_) return;
    Forget();
    // A close frame holds at most 123 bytes of text; it waits for the write that is going on.
    stream_.async_close(websocket::close_reason(code, beast::string_view(why).substr(0, 120)),
                        [self = shared_from_this()](error_code) {});
  }

  /// The client is gone, or as good as gone: nothing is sent to it any more. The user hears of it later, because it may
  /// be in the midst of sending to all clients.
  void Forget() {
    open_ = false;
    server_.sessions.erase(id_);
    while (out_.size() > 1) TakeOut(out_.end() - 1);  // the first is being written
    if (!std::exchange(told_, false)) return;
    asio::post(server_.io,
               [self = shared_from_this()] { self->Guard([&] { self->server_.user.OnClose(self->id_); }); });
  }

  template <class Function>
  void Guard(const Function& function) {
    try {
      function();
    } catch (const std::exception& error) {
      Drop(std::string("an error of ours: ") + error.what());
    }
  }

  Server& server_;
  const ClientId id_;
  const std::string name_;
  websocket::stream<beast::tcp_stream> stream_;
  beast::flat_buffer in_;
  std::deque<Frame> out_;  // the first one is being written
  std::size_t waiting_bytes_ = 0;
  bool open_ = false, told_ = false, goodbye_ = false;
};

/// A connection by HTTP, until it ends or becomes a Session.
class Visit : public std::enable_shared_from_this<Visit> {
 public:
  Visit(Server& server, tcp::socket socket) : server_(server), name_(NameOf(socket)), stream_(std::move(socket)) {
    ++server_.connections;
    server_.streams.insert(&stream_);
  }
  ~Visit() {
    server_.streams.erase(&stream_);
    --server_.connections;
  }
  Visit(const Visit&) = delete;
  Visit& operator=(const Visit&) = delete;

  void Read() {
    parser_.emplace();
    parser_->header_limit(8 << 10);
    stream_.expires_after(server_.options.limits.handshake);
    http::async_read(stream_, in_, *parser_,
                     [self = shared_from_this()](error_code error, std::size_t) { self->OnRead(error); });
  }

 private:
  void OnRead(error_code error) {
    if (error || server_.ending) return;  // the socket closes with this object
    const HttpRequest& request = parser_->get();
    if (const auto refusal = server_.origin_check.Judge(CallerOf(request)))
      return Refuse(refusal->status, refusal->answer, refusal->words);
    if (websocket::is_upgrade(request)) return Upgrade(request);
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return Answer({405, {{"Allow", "GET, HEAD"}}, "expected GET\n"});
    try {
      Answer(server_.user.Get(View(request.target())));
    } catch (const std::exception& failure) {
      Answer({500, {}, std::string(failure.what()) + "\n"});
    }
  }

  static Caller CallerOf(const HttpRequest& request) {
    const auto all = [&](http::field field) {
      std::vector<std::string_view> values;
      const auto range = request.equal_range(field);
      for (auto header = range.first; header != range.second; ++header) values.push_back(View(header->value()));
      return values;
    };
    return {.hosts = all(http::field::host), .origins = all(http::field::origin), .target = View(request.target())};
  }

  void Refuse(unsigned status, const std::string& answer, const std::string& words) {
    server_.LogRefusal(name_, words);
    Answer({status, {}, answer});
  }

  void Upgrade(const HttpRequest& request) {
    if (server_.sessions.size() >= server_.options.limits.clients)
      return Refuse(503, "too many viewers\n", "there are " + std::to_string(server_.sessions.size()) + " viewers");
    http::token_list offered(request[http::field::sec_websocket_protocol]);
    for (const std::string& ours : server_.options.subprotocols)
      if (offered.exists(ours)) {
        stream_.expires_never();
        return std::make_shared<Session>(server_, stream_.release_socket())->Accept(request, ours);
      }
    Refuse(400, "expected a WebSocket subprotocol that this server speaks\n",
           "a WebSocket without a subprotocol that this server speaks");
  }

  void Answer(const HttpAnswer& answer) {
    const HttpRequest& request = parser_->get();
    response_.emplace(http::status(answer.status), request.version());
    response_->set(http::field::content_type, "text/plain; charset=utf-8");
    response_->set("X-Content-Type-Options", "nosniff");
    for (const auto& [name, value] : answer.headers) response_->set(name, value);
    response_->content_length(answer.body.size());
    if (request.method() != http::verb::head) response_->body() = answer.body;
    response_->keep_alive(request.keep_alive() && answer.status == 200);
    stream_.expires_after(server_.options.limits.handshake);
    http::async_write(stream_, *response_,
                      [self = shared_from_this()](error_code error, std::size_t) { self->OnAnswered(error); });
  }

  void OnAnswered(error_code error) {
    if (error) return;
    if (response_->keep_alive()) return Read();
    stream_.socket().shutdown(tcp::socket::shutdown_send, error);
  }

  Server& server_;
  const std::string name_;
  beast::tcp_stream stream_;
  beast::flat_buffer in_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::optional<Response> response_;
};

/// A socket that listens, and that no child inherits.
int Listen(const tcp::endpoint& at) {
  const int socket = ::socket(at.protocol().family(), SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (socket >= 0 && bind(socket, at.data(), static_cast<socklen_t>(at.size())) == 0 && listen(socket, 128) == 0)
    return socket;
  const int error = errno;
  if (socket >= 0) ::close(socket);
  errno = error;
  return -1;
}

}  // namespace

class SocketServer::Impl {
 public:
  Impl(SocketOptions options, SocketUser& user, std::function<void(const std::string&)> log)
      : server_{.options = std::move(options), .user = user, .log = std::move(log), .origin_check = {"", "", {}}},
        acceptor_(server_.io),
        timer_(server_.io),
        pause_(server_.io) {
    Bind();
    const std::string address = acceptor_.local_endpoint().address().to_string();
    url_ = UrlOf(acceptor_.local_endpoint());
    port_ = acceptor_.local_endpoint().port();
    server_.origin_check = {server_.options.address, address, server_.options.allowed_origins};
  }
  ~Impl() {
    if (!thread_.joinable()) return;
    Post([this] { End(); });
    thread_.join();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void Start() {
    Await();
    Tick();
    thread_ = std::thread([this] { Run(); });
  }

  const std::string& url() const { return url_; }
  std::uint16_t port() const { return port_; }
  void Post(std::function<void()> function) {
    if (!has_failed_) asio::post(server_.io, std::move(function));
  }
  bool has_failed() const { return has_failed_; }
  void Send(ClientId client, Frame frame) {
    if (const auto session = server_.sessions.find(client); session != server_.sessions.end())
      session->second->Send(std::move(frame));
  }
  std::size_t Waiting(ClientId client) const {
    const auto session = server_.sessions.find(client);
    return session == server_.sessions.end() ? 0 : session->second->waiting();
  }

 private:
  static std::string UrlOf(const tcp::endpoint& at) {
    const std::string address = at.address().to_string();
    return "http://" + (at.address().is_v6() ? "[" + address + "]" : address) + ":" + std::to_string(at.port());
  }

  void Run() {
    try {
      server_.io.run();
    } catch (...) {
      GiveUp(CaughtInWords());
    }
  }

  /// Ends everything at once: nothing here is to be trusted any more. What waits in server_.io is freed with it.
  void GiveUp(const std::string& why) {
    has_failed_ = true;
    server_.ending = true;
    error_code ignored;
    acceptor_.close(ignored);
    for (beast::tcp_stream* stream : server_.streams) stream->socket().close(ignored);
    try {
      server_.log("viewers: the view has ended because of an error of ours, and nothing else has: " + why);
    } catch (const std::exception&) {  // out of memory, say
    }
  }

  void Bind() {
    const SocketOptions& options = server_.options;
    const auto fail = [&](const std::string& why) {
      throw std::runtime_error("cannot listen on " + options.address + ":" + std::to_string(options.port) + ": " + why);
    };
    error_code error;
    tcp::resolver resolver(server_.io);
    const auto found = resolver.resolve(options.address, "", tcp::resolver::passive, error);
    if (error) fail(error.message());
    tcp::endpoint at = found.begin()->endpoint();
    for (int more = 0;; ++more) {
      at.port(static_cast<unsigned short>(options.port + (options.port == 0 ? 0 : more)));
      if (const int socket = Listen(at); socket >= 0) return acceptor_.assign(at.protocol(), socket);
      if (errno != EADDRINUSE || more == kPortsToTry || options.port + more >= 65535) fail(std::strerror(errno));
    }
  }

  void Await() {
    acceptor_.async_wait(tcp::acceptor::wait_read, [this](error_code error) {
      if (error) return;
      if (Accept()) return Await();
      pause_.expires_after(kFullPause);
      pause_.async_wait([this](error_code stopped) {
        if (!stopped) Await();
      });
    });
  }

  /// False if no client can be let in now, because this process or the machine has no descriptor, or no memory, left.
  bool Accept() {
    const int socket = ::accept4(acceptor_.native_handle(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (socket < 0) return !HasNoRoom(errno);
    setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kSendBuffer_bytes, sizeof kSendBuffer_bytes);
    tcp::socket accepted(server_.io, acceptor_.local_endpoint().protocol(), socket);
    error_code ignored;
    accepted.set_option(tcp::no_delay(true), ignored);
    if (server_.connections >= server_.options.limits.connections) {
      server_.LogRefusal(NameOf(accepted), "there are " + std::to_string(server_.connections) + " connections");
      return true;
    }
    std::make_shared<Visit>(server_, std::move(accepted))->Read();
    return true;
  }

  void Tick() {
    const auto now = std::chrono::steady_clock::now();
    timer_.expires_at(std::max(now, timer_.expiry() + server_.options.period));
    timer_.async_wait([this](error_code error) {
      if (error || server_.ending) return;
      server_.user.OnTimer();
      Tick();
    });
  }

  void End() {
    server_.ending = true;
    acceptor_.close();
    timer_.cancel();
    pause_.cancel();
    for (const auto& [id, session] : std::map(server_.sessions)) session->SayGoodbye();
    AwaitGoodbyes(std::chrono::steady_clock::now() + server_.options.limits.goodbye);
  }

  void AwaitGoodbyes(std::chrono::steady_clock::time_point until) {
    if (server_.by_websocket == 0 || std::chrono::steady_clock::now() > until) return server_.io.stop();
    timer_.expires_after(kGoodbyeLook);
    timer_.async_wait([this, until](error_code) { AwaitGoodbyes(until); });
  }

  Server server_;
  tcp::acceptor acceptor_;
  asio::steady_timer timer_, pause_;
  std::string url_;
  std::uint16_t port_ = 0;
  std::atomic<bool> has_failed_ = false;
  std::thread thread_;
};

SocketServer::SocketServer(SocketOptions options, SocketUser& user, std::function<void(const std::string&)> log)
    : impl_(std::make_unique<Impl>(std::move(options), user, std::move(log))) {}
SocketServer::~SocketServer() = default;
void SocketServer::Start() { impl_->Start(); }
std::string SocketServer::url() const { return impl_->url(); }
std::uint16_t SocketServer::port() const { return impl_->port(); }
void SocketServer::Post(std::function<void()> function) { impl_->Post(std::move(function)); }
void SocketServer::Fail(const std::string& why) {
  impl_->Post([why] { throw std::runtime_error(why); });
}
bool SocketServer::has_failed() const { return impl_->has_failed(); }
void SocketServer::Send(ClientId client, Frame frame) { impl_->Send(client, std::move(frame)); }
std::size_t SocketServer::Waiting(ClientId client) const { return impl_->Waiting(client); }

}  // namespace mascot
