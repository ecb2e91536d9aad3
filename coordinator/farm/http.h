// SPDX-License-Identifier: Apache-2.0
// GET /metrics and GET /healthz for those who watch over a coordinator. It answers from the last figures that
// were posted and never touches the farm. Nobody is asked for a key, so it is found on loopback only. The
// only file pair that sees cpp-httplib.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "coordinator/farm/figures.h"
#include "core/instant.h"

namespace tessera {

// The last figures, between the farm's thread and HTTP's.
class FigureBoard {
 public:
  void post(std::shared_ptr<const FarmFigures> figures, Instant now);
  struct Posted {
    std::shared_ptr<const FarmFigures> figures;  // null: none yet
    Instant when{};
  };
  Posted last() const;

 private:
  mutable std::mutex mutex_;
  Posted last_;
};

// Empty: the coordinator works. Else why not, for people; a loop that posts once a second and has not for
// five is stuck.
std::string health_trouble(const FigureBoard::Posted&, Instant now);

class HttpServer {
 public:
  // Listens at once, in threads of its own, until it is destroyed. `board` is borrowed. Port 0: any that is
  // free. Throws Error(bad_usage) unless `host` is localhost or an address of loopback, Error(unreachable) if
  // it cannot listen there.
  HttpServer(const std::string& host, int port, const FigureBoard& board, std::function<Instant()> now);
  ~HttpServer();
  int port() const { return port_; }

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
  int port_ = 0;
};

}  // namespace tessera
