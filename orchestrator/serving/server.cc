#include "orchestrator/serving/server.h"

#include <fmt/format.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <utility>

#include "experiment/toml/section.h"
#include "orchestrator/serving/binary_form.h"

namespace mascot {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

constexpr auto kLook = std::chrono::milliseconds(100);

std::string TextOf(const tcp::endpoint& endpoint) {
  const std::string address = endpoint.address().to_string();
  return (endpoint.address().is_v6() ? '[' + address + ']' : address) + ':' + std::to_string(endpoint.port());
}

}  // namespace

class ServeSocket::Impl {
 public:
  Impl(const LiveAddress& at, TeamService& team, ServeLimits limits)
      : team_(team), limits_(limits), acceptor_(io_), timer_(io_), pause_(io_) {
    try {
      tcp::resolver resolver(io_);
      const tcp::endpoint endpoint = *resolver.resolve(at.address, std::to_string(at.port)).begin();
      acceptor_.open(endpoint.protocol());
      acceptor_.set_option(tcp::acceptor::reuse_address(true));
      acceptor_.bind(endpoint);
      acceptor_.listen();
    } catch (const boost::system::system_error& error) {
      throw ConfigError({fmt::format("--at: cannot listen at {}:{}: {}", at.address, at.port, error.code().message())});
    }
  }
  std::string address() const { return TextOf(acceptor_.local_endpoint()); }

  void Run(const std::function<bool()>& goes_on, bool once, std::chrono::seconds patience) {
    once_ = once;
    give_up_ = Clock::now() + patience;
    Accept();
    Look(goes_on);
    io_.run();
  }

 private:
  class Client;

  void Accept();
  void Look(const std::function<bool()>& goes_on) {
    if (!goes_on() || (once_ && driver_ == nullptr && Clock::now() > give_up_)) return io_.stop();
    timer_.expires_after(kLook);
    timer_.async_wait([this, &goes_on](error_code error) {
      if (!error) Look(goes_on);
    });
  }

  TeamService& team_;
  const ServeLimits limits_;
  asio::io_context io_{1};
  tcp::acceptor acceptor_;
  asio::steady_timer timer_, pause_;  // of Look(); between two attempts to accept a client
  std::size_t clients_ = 0;
  const Client* driver_ = nullptr;  // the client that steps the team
  std::string driver_name_;
  bool once_ = false;
  Clock::time_point give_up_;
};

/// One connection. It lives as long as one of its operations is going on.
class ServeSocket::Impl::Client : public std::enable_shared_from_this<Client> {
 public:
  Client(Impl& server, tcp::socket socket)
      : server_(server),
        socket_(std::move(socket)),
        timer_(server.io_),
        talk_(
            server.team_, [this](const std::string& request) { Drive(request); }, server.limits_.messages) {
    error_code ignored;
    const tcp::endpoint peer = socket_.remote_endpoint(ignored);
    if (!ignored) name_ = TextOf(peer);
    socket_.set_option(tcp::no_delay(true), ignored);
    ++server_.clients_;
  }
  ~Client() {
    --server_.clients_;
    if (server_.driver_ != this) return;
    server_.driver_ = nullptr;
    if (server_.once_) server_.io_.stop();
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void Begin() {
    if (server_.clients_ > server_.limits_.clients)
      return Send(talk_.Refuse(fmt::format("{} clients are connected, as many as may be", server_.limits_.clients)));
    timer_.expires_after(server_.limits_.hello);
    timer_.async_wait([me = weak_from_this()](error_code error) {
      const auto self = me.lock();
      if (!error && self && !self->talk_.is_known()) self->Close();
    });
    ReadLine();
  }

 private:
  void ReadLine() {
    asio::async_read_until(
        socket_, asio::dynamic_buffer(in_, talk_.most()), '\n',
        [self = shared_from_this()](error_code error, std::size_t length) { self->OnLine(error, length); });
  }

  void OnLine(error_code error, std::size_t length) {
    if (error == asio::error::not_found)
      return Send(talk_.Refuse(fmt::format("expected a line of at most {} bytes", talk_.most())));
    if (error) return;
    const std::string line = in_.substr(0, length - 1);
    in_.erase(0, length);
    Send(talk_.OnLine(line));
  }

  /// How many bytes are still to be read until there are `bytes`.
  auto MissingTo(std::size_t bytes) const {
    return asio::transfer_exactly(in_.size() < bytes ? bytes - in_.size() : 0);
  }
  void ReadFrame() {
    asio::async_read(socket_, asio::dynamic_buffer(in_), MissingTo(kFrameHead),
                     [self = shared_from_this()](error_code error, std::size_t) {
                       if (!error) self->OnFrameHead();
                     });
  }
  void OnFrameHead() {
    std::uint32_t length = 0;
    std::memcpy(&length, in_.data(), sizeof length);
    if (length < 1 || length > talk_.most())
      return Send(talk_.Refuse(fmt::format("expected a frame of 1 to {} bytes, got one of {}", talk_.most(), length)));
    asio::async_read(socket_, asio::dynamic_buffer(in_), MissingTo(kFrameLength + length),
                     [self = shared_from_this(), length](error_code error, std::size_t) {
                       if (!error) self->OnFrame(length);
                     });
  }
  void OnFrame(std::size_t length) {
    const std::string content = in_.substr(kFrameHead, length - 1);
    const auto kind = static_cast<std::uint8_t>(in_[kFrameLength]);
    in_.erase(0, kFrameLength + length);
    Send(talk_.OnFrame(kind, content));
  }

  /// Makes this client the one that steps the team. Throws std::runtime_error if another one does.
  void Drive(const std::string& request) {
    if (server_.driver_ == nullptr) {
      server_.driver_ = this;
      server_.driver_name_ = name_;
    }
    if (server_.driver_ != this)
      throw std::runtime_error(fmt::format("{}: another client steps this team: {}", request, server_.driver_name_));
  }

  void Send(std::string message) {
    out_ = std::move(message);
    asio::async_write(socket_, asio::buffer(out_), [self = shared_from_this()](error_code error, std::size_t) {
      if (error || self->talk_.is_over()) return self->Close();
      self->talk_.is_binary() ? self->ReadFrame() : self->ReadLine();
    });
  }

  void Close() {
    error_code ignored;
    timer_.cancel(ignored);
    socket_.shutdown(tcp::socket::shutdown_both, ignored);
    socket_.close(ignored);
  }

  Impl& server_;
  tcp::socket socket_;
  asio::steady_timer timer_;
  std::string name_ = "a client that is gone";
  Conversation talk_;
  std::string in_, out_;  // in_: what has come of the next messages
};

void ServeSocket::Impl::Accept() {
  acceptor_.async_accept([this](error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) {
      std::make_shared<Client>(*this, std::move(socket))->Begin();
      return Accept();
    }
    pause_.expires_after(kLook);  // there are too many descriptors: the client waits
    pause_.async_wait([this](error_code over) {
      if (!over) Accept();
    });
  });
}

ServeSocket::ServeSocket(const LiveAddress& at, TeamService& team, ServeLimits limits)
    : impl_(std::make_unique<Impl>(at, team, limits)) {}
ServeSocket::~ServeSocket() = default;
std::string ServeSocket::address() const { return impl_->address(); }
void ServeSocket::Run(const std::function<bool()>& goes_on, bool once, std::chrono::seconds patience) {
  impl_->Run(goes_on, once, patience);
}

}  // namespace mascot
