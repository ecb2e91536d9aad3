// SPDX-License-Identifier: Apache-2.0
#include "coordinator/farm/http.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <httplib.h>

#include <atomic>
#include <semaphore>
#include <thread>

#include "coordinator/farm/metrics.h"
#include "core/error.h"

namespace tessera {
namespace {

constexpr int kThreads = 8, kConnections = 16;  // at work; with those that wait, the kernel's aside
constexpr std::size_t kMostBody = 1024;         // of a request, which needs none
constexpr std::chrono::seconds kSilence{1};     // of a peer that has connected
constexpr std::chrono::seconds kPatience{2};    // for a peer that does not go on
constexpr std::chrono::seconds kStuck{5};

// The server takes no more connections than there is room for.
class Desks : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> work) override {
    room_.acquire();
    pool_.enqueue([this, work = std::move(work)] {
      work();
      room_.release();
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  std::counting_semaphore<kConnections> room_{kConnections};
  httplib::ThreadPool pool_{kThreads};
};

bool is_loopback(const std::string& host) {
  in_addr v4{};
  in6_addr v6{};
  if (inet_pton(AF_INET, host.c_str(), &v4) == 1) return ntohl(v4.s_addr) >> 24 == 127;
  if (inet_pton(AF_INET6, host.c_str(), &v6) == 1) return IN6_IS_ADDR_LOOPBACK(&v6);
  return host == "localhost";
}

}  // namespace

void FigureBoard::post(std::shared_ptr<const FarmFigures> figures, Instant now) {
  const std::lock_guard lock(mutex_);
  last_ = {std::move(figures), now};
}

FigureBoard::Posted FigureBoard::last() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

std::string health_trouble(const FigureBoard::Posted& last, Instant now) {
  if (!last.figures) return "the coordinator has not begun yet";
  if (now - last.when > kStuck)
    return fmt::format("the coordinator's loop has not turned for {:.0f} s", seconds_between(last.when, now));
  return last.figures->trouble;
}

struct HttpServer::Inside {
  httplib::Server server;
  std::atomic<bool> ended = false;
  std::jthread thread;
};

HttpServer::HttpServer(const std::string& host, int port, const FigureBoard& board,
                       std::function<Instant()> now)
    : inside_(std::make_unique<Inside>()) {
  if (!is_loopback(host))
    throw Error(
        ExitCode::bad_usage,
        fmt::format("--http: {} is not on this machine alone; accepted: localhost, 127.0.0.1 or ::1, as "
                    "nobody is asked for a key there",
                    host));
  httplib::Server& server = inside_->server;
  // Two coordinators are not to share a port, which is the library's default.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.new_task_queue = [] { return new Desks; };  // the server's to delete
  server.set_keep_alive_max_count(1);
  server.set_keep_alive_timeout(kSilence.count());  // for the first word
  server.set_payload_max_length(kMostBody);
  server.set_read_timeout(kPatience);
  server.set_write_timeout(kPatience);
  server.Get("/metrics", [&board](const httplib::Request&, httplib::Response& answer) {
    const FigureBoard::Posted last = board.last();
    if (!last.figures) {
      answer.status = 503;
      return answer.set_content("the coordinator has not begun yet\n", "text/plain");
    }
    answer.set_content(metrics_text(*last.figures), kMetricsType);
  });
  server.Get("/healthz", [&board, now = std::move(now)](const httplib::Request&, httplib::Response& answer) {
    const std::string trouble = health_trouble(board.last(), now());
    answer.status = trouble.empty() ? 200 : 503;
    answer.set_content((trouble.empty() ? "ok" : trouble) + "\n", "text/plain");
  });
  port_ = port == 0 ? server.bind_to_any_port(host) : server.bind_to_port(host, port) ? port : -1;
  if (port_ <= 0)
    throw Error(ExitCode::unreachable, fmt::format("--http: cannot listen on port {} of {}", port, host));
  inside_->thread = std::jthread([&inside = *inside_] {
    inside.server.listen_after_bind();
    inside.ended = true;
  });
}

// It can only be stopped once it runs, and it does as soon as its thread has come so far.
HttpServer::~HttpServer() {
  while (!inside_->server.is_running() && !inside_->ended) std::this_thread::yield();
  inside_->server.stop();
}

}  // namespace tessera
