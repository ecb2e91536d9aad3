// SPDX-License-Identifier: Apache-2.0
#include "proto/key_files.h"

#include "core/error.h"

namespace tessera {

std::optional<ServerKeys> read_server_keys(const KeyFiles& files) {
  if (files.key.empty() && files.allow.empty()) return std::nullopt;
  if (files.key.empty() || files.allow.empty())
    throw Error(ExitCode::bad_usage,
                "keys: a coordinator needs both its own, --key, and those it lets in, --allow");
  return ServerKeys{read_secret_key(files.key), read_allow_list(files.allow)};
}

std::optional<ClientKeys> read_client_keys(const KeyFiles& files) {
  if (files.key.empty() && files.server_key.empty()) return std::nullopt;
  if (files.key.empty() || files.server_key.empty())
    throw Error(ExitCode::bad_usage, "keys: needs both its own, --key, and the coordinator's, --server-key");
  return ClientKeys{read_secret_key(files.key), read_public_keys(files.server_key)};
}

}  // namespace tessera
