// SPDX-License-Identifier: Apache-2.0
// Who may come, and as what: a text with a key a line.
//
//   # role[,role]            name    public key
//   worker                   rack1   8Kv2…
//   submitter,administrator  ada     rq:mM…
//
// A name may have several keys (while one is changed for another), always with the same roles.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "proto/transport.h"

namespace tessera {

struct AllowList {
  std::map<std::string, Identity, std::less<>> keys;  // by public key
  const Identity* find(std::string_view public_key) const;
  bool operator==(const AllowList&) const = default;
};

// Throws InputError(where:line) for a line that is none, a role that is none, a name that is not 1 to 32
// letters, digits, '.', '_' or '-' or is "local", a key that is none or comes twice, other roles under the
// same name; and for a list that allows nobody, which is what a file looks like while it is written.
AllowList parse_allow_list(std::string_view text, std::string_view where);
AllowList read_allow_list(const std::filesystem::path&);

}  // namespace tessera
