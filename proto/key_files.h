// SPDX-License-Identifier: Apache-2.0
// What a coordinator and what its peers must know of keys, and the files they read it from.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "proto/allow_list.h"
#include "proto/keys.h"

namespace tessera {

// Of a coordinator.
struct ServerKeys {
  KeyPair pair;
  AllowList allowed;
  bool operator==(const ServerKeys&) const = default;
};

// Of a worker or a command.
struct ClientKeys {
  KeyPair pair;
  std::vector<std::string> servers;  // public keys a coordinator may have, at least one; tried in turn
  bool operator==(const ClientKeys&) const = default;
};

struct KeyFiles {
  std::filesystem::path key;         // of this process: secret
  std::filesystem::path allow;       // a coordinator's allow-list
  std::filesystem::path server_key;  // what its peers know of it: public
};

// Nothing if no file is named. Throws Error(bad_usage) if one of the two that are needed is missing, and what
// reading them throws.
std::optional<ServerKeys> read_server_keys(const KeyFiles&);
std::optional<ClientKeys> read_client_keys(const KeyFiles&);

}  // namespace tessera
