// SPDX-License-Identifier: Apache-2.0
// How commands reach a farm's coordinator: options, connection, questions.
#pragma once

#include <CLI/CLI.hpp>

#include <memory>
#include <string>

#include "cli/key_options.h"
#include "cli/link_options.h"
#include "proto/client.h"
#include "proto/zmq_transport.h"

namespace tessera {

// --coordinator, --timeout, --key, --server-key.
void add_link_options(CLI::App&, LinkOptions&);

class FarmLink {
 public:
  // Throws what reading the keys throws, and Error(bad_usage) for an address that is none.
  explicit FarmLink(const LinkOptions& options);

  FarmClient& client() { return client_; }

  // The answer, which is of that kind. Throws Error(unreachable) after the timeout, and what the coordinator
  // denies with its code and reason.
  template <class Kind>
  Kind ask(Question question) {
    return std::get<Kind>(client_.ask(std::move(question)));
  }

 private:
  ZmqContext context_;
  FarmClient client_;
};

// A road to the coordinator of those options, under that id.
std::unique_ptr<ZmqDealer> road_to(ZmqContext&, const LinkOptions&, const std::string& id);

// A name that no other peer or job has: a word for people, of which characters that names may not have become
// '_', and chance.
std::string own_id(const std::string& word);

// How far an upload is, on a terminal.
FarmClient::Progress upload_bar(bool quiet);

}  // namespace tessera
