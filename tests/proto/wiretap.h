// SPDX-License-Identifier: Apache-2.0
// Somebody on the road who has no key: a TCP connection that says what it likes, and a relay that writes down
// what passes and may change it.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

namespace tessera {

class TcpPeer {
 public:
  explicit TcpPeer(int port) : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const sockaddr_in to = loopback(port);
    if (connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
      throw std::runtime_error("cannot connect");
  }
  explicit TcpPeer(int fd, std::nullptr_t) : fd_(fd) {}
  ~TcpPeer() { close(fd_); }
  TcpPeer(const TcpPeer&) = delete;
  TcpPeer& operator=(const TcpPeer&) = delete;

  // False if the other end has closed.
  bool say(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (n <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
  }
  void end() { shutdown(fd_, SHUT_WR); }  // nothing more will be said

  // What has come; sets `closed` if nothing more will.
  std::string hear(int wait_ms, bool& closed) {
    pollfd p{fd_, POLLIN, 0};
    if (poll(&p, 1, wait_ms) <= 0) return {};
    char bytes[65536];
    const ssize_t n = recv(fd_, bytes, sizeof bytes, MSG_DONTWAIT);
    closed = n <= 0;
    return std::string(bytes, static_cast<std::size_t>(n > 0 ? n : 0));
  }
  int fd() const { return fd_; }

  static sockaddr_in loopback(int port) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return to;
  }

 private:
  int fd_;
};

// Relays one connection after the other to `port`. `change` may alter what goes towards it, of which
// `so_far` bytes have gone already.
class Wiretap {
 public:
  using Change = std::function<void(std::string& bytes, std::size_t so_far)>;

  explicit Wiretap(int port, Change change = {})
      : change_(std::move(change)), listening_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in at = TcpPeer::loopback(0);
    socklen_t size = sizeof at;
    if (bind(listening_, reinterpret_cast<sockaddr*>(&at), size) != 0 || listen(listening_, 8) != 0 ||
        getsockname(listening_, reinterpret_cast<sockaddr*>(&at), &size) != 0)
      throw std::runtime_error("cannot listen");
    port_ = ntohs(at.sin_port);
    thread_ = std::jthread([this, port](const std::stop_token& stop) { run(stop, port); });
  }
  ~Wiretap() {
    thread_ = {};
    close(listening_);
  }

  std::string endpoint() const { return "tcp://127.0.0.1:" + std::to_string(port_); }
  // What went towards the port over the latest connection.
  std::string written_down() const {
    const std::lock_guard lock(mutex_);
    return written_;
  }

 private:
  void run(const std::stop_token& stop, int port) {
    while (!stop.stop_requested()) {
      pollfd p{listening_, POLLIN, 0};
      if (poll(&p, 1, 10) <= 0) continue;
      TcpPeer near(accept(listening_, nullptr, nullptr), nullptr), far(port);
      {
        const std::lock_guard lock(mutex_);
        written_.clear();
      }
      relay(stop, near, far);
    }
  }

  void relay(const std::stop_token& stop, TcpPeer& near, TcpPeer& far) {
    for (bool closed = false; !closed && !stop.stop_requested();) {
      pollfd both[] = {{near.fd(), POLLIN, 0}, {far.fd(), POLLIN, 0}};
      if (poll(both, 2, 10) <= 0) continue;
      if (both[0].revents != 0) {
        std::string bytes = near.hear(0, closed);
        const std::lock_guard lock(mutex_);
        if (change_) change_(bytes, written_.size());
        written_ += bytes;
        far.say(bytes);
      }
      if (both[1].revents != 0) near.say(far.hear(0, closed));
    }
  }

  Change change_;
  int listening_, port_ = 0;
  mutable std::mutex mutex_;  // guards written_
  std::string written_;
  std::jthread thread_;
};

}  // namespace tessera
