// SPDX-License-Identifier: Apache-2.0
#include "proto/keys.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "proto/key_lines.h"

namespace tessera {
namespace {

constexpr std::string_view kAlphabet =
    "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-:+=^!/*?&<>()[]{}@%$#";
using Text = std::array<char, kKeyText + 1>;

// The keys of the lines "`word` KEY", which is all there may be.
std::vector<std::string> keys_of(const std::filesystem::path& file, const std::string& word, bool secret) {
  std::vector<std::string> keys;
  for (const KeyLine& line : key_lines(read_key_text(file, secret), file.string())) {
    if (line.words.size() != 2 || line.words[0] != word || !is_key(line.words[1]))
      throw InputError(fmt::format("{}:{}", file.string(), line.number), "is no key",
                       fmt::format("'{} ' and 40 characters, as 'tessera keygen' writes them", word));
    keys.push_back(line.words[1]);
  }
  if (keys.empty())
    throw InputError(file.string(), "holds no key",
                     fmt::format("'{} ' and 40 characters, as 'tessera keygen' writes them", word));
  return keys;
}

void write_new(const std::filesystem::path& file, const std::string& text, mode_t mode) {
  const int fd = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (fd < 0 && errno == EEXIST)
    throw Error(ExitCode::bad_usage, file.string() + ": is there already; keys are never written over");
  const bool written = fd >= 0 && fchmod(fd, mode) == 0 &&
                       write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                       fsync(fd) == 0;
  const int why = errno;
  if (fd >= 0) close(fd);
  if (!written) throw InputError(file.string(), fmt::format("cannot be written: {}", std::strerror(why)));
}

}  // namespace

KeyPair make_key_pair() {
  Text open{}, secret{};
  if (zmq_curve_keypair(open.data(), secret.data()) != 0)
    throw Error(ExitCode::internal_error, "this ZeroMQ was built without CURVE");
  return {open.data(), secret.data()};
}

bool is_key(std::string_view text) {
  return text.size() == kKeyText &&
         std::ranges::all_of(text, [](char c) { return kAlphabet.find(c) != kAlphabet.npos; });
}

KeyPair read_secret_key(const std::filesystem::path& file) {
  const std::vector<std::string> keys = keys_of(file, "secret-key", true);
  if (keys.size() != 1) throw InputError(file.string(), "holds several keys", "one");
  Text open{};
  if (zmq_curve_public(open.data(), keys[0].c_str()) != 0)
    throw InputError(file.string(), "is no key", "a file that 'tessera keygen' wrote");
  return {open.data(), keys[0]};
}

std::vector<std::string> read_public_keys(const std::filesystem::path& file) {
  return keys_of(file, "public-key", false);
}

void write_key_files(const std::filesystem::path& stem, const KeyPair& pair) {
  std::filesystem::path secret = stem, open = stem;
  secret += ".key";
  open += ".pub";
  if (std::filesystem::exists(open))
    throw Error(ExitCode::bad_usage, open.string() + ": is there already; keys are never written over");
  write_new(secret, "# Secret: whoever has this file is taken for you.\nsecret-key " + pair.secret_key + "\n",
            0600);
  write_new(open, "public-key " + pair.public_key + "\n", 0644);
}

}  // namespace tessera
