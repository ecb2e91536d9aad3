// SPDX-License-Identifier: Apache-2.0
#include "proto/allow_list.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/nearest.h"
#include "proto/codec.h"
#include "proto/key_lines.h"
#include "proto/keys.h"

namespace tessera {
namespace {

constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";

bool is_name(std::string_view name) {
  return !name.empty() && name.size() <= kMaxKeyName && name.find_first_not_of(kLetters) == name.npos &&
         name != "local";
}

// "worker,submitter" gives `who` these roles and no others.
void set_roles(Identity& who, std::string_view words, std::string_view where) {
  const std::vector<std::string_view> known{"worker", "submitter", "administrator"};
  who.worker = who.submitter = who.administrator = false;
  for (std::size_t begin = 0; begin <= words.size();) {
    const std::size_t end = std::min(words.find(',', begin), words.size());
    const std::string_view role = words.substr(begin, end - begin);
    if (std::ranges::find(known, role) == known.end())
      throw InputError(where, unknown("role", role, known), listed(known));
    (role == "worker" ? who.worker : role == "submitter" ? who.submitter : who.administrator) = true;
    begin = end + 1;
  }
}

}  // namespace

const Identity* AllowList::find(std::string_view public_key) const {
  const auto it = keys.find(public_key);
  return it == keys.end() ? nullptr : &it->second;
}

AllowList parse_allow_list(std::string_view text, std::string_view file) {
  AllowList list;
  std::map<std::string, Identity> names;
  for (const KeyLine& line : key_lines(text, file)) {
    const std::string where = fmt::format("{}:{}", file, line.number);
    if (line.words.size() != 3)
      throw InputError(where, fmt::format("has {} words", line.words.size()), "ROLE[,ROLE] NAME PUBLIC-KEY");
    Identity who{.name = line.words[1]};
    set_roles(who, line.words[0], where);
    if (!is_name(who.name))
      throw InputError(where, fmt::format("'{}' is no name", who.name),
                       "1 to 32 letters, digits, '.', '_', '-'; not 'local'");
    if (!is_key(line.words[2]))
      throw InputError(where, fmt::format("'{}' is no public key", line.words[2]),
                       "40 characters, as 'tessera keygen' prints them");
    if (const auto [same, fresh] = names.emplace(who.name, who); !fresh && same->second != who)
      throw InputError(where, fmt::format("'{}' has other roles further up", who.name), "the same roles");
    if (!list.keys.emplace(line.words[2], who).second)
      throw InputError(where, "the key is there already", "each key once");
  }
  if (list.keys.empty()) throw InputError(file, "allows nobody", "at least one line ROLE NAME PUBLIC-KEY");
  return list;
}

AllowList read_allow_list(const std::filesystem::path& file) {
  return parse_allow_list(read_key_text(file, false), file.string());
}

}  // namespace tessera
