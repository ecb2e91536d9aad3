// SPDX-License-Identifier: Apache-2.0
#include "proto/key_lines.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/error.h"

namespace tessera {
namespace {

constexpr std::size_t kMaxText = std::size_t{16} << 20;

std::vector<std::string> words_of(std::string_view line) {
  constexpr std::string_view kSpace = " \t\r";
  std::vector<std::string> words;
  for (;;) {
    const std::size_t begin = line.find_first_not_of(kSpace);
    if (begin == line.npos) return words;
    const std::size_t end = std::min(line.find_first_of(kSpace, begin), line.size());
    const std::string_view word = line.substr(begin, end - begin);
    if (word == "#" || (words.empty() && word[0] == '#')) return words;
    words.emplace_back(word);
    line.remove_prefix(end);
  }
}

// An open file that is closed in the end.
struct Descriptor {
  int fd;
  explicit Descriptor(const std::filesystem::path& file) : fd(open(file.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~Descriptor() {
    if (fd >= 0) close(fd);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

}  // namespace

std::vector<KeyLine> key_lines(std::string_view text, std::string_view where) {
  std::vector<KeyLine> lines;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    if (std::ranges::any_of(line, [](unsigned char c) { return c < ' ' && c != '\t' && c != '\r'; }))
      throw InputError(fmt::format("{}:{}", where, number), "is no line of text");
    if (std::vector<std::string> words = words_of(line); !words.empty())
      lines.push_back({number, std::move(words)});
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::string read_key_text(const std::filesystem::path& path, bool secret) {
  const auto fail = [&] {
    throw InputError(path.string(), fmt::format("cannot be read: {}", std::strerror(errno)));
  };
  const Descriptor file(path);
  struct stat status = {};
  if (file.fd < 0 || fstat(file.fd, &status) != 0) fail();
  if (!S_ISREG(status.st_mode)) throw InputError(path.string(), "is not a file");
  if (secret && (status.st_mode & 077) != 0)
    throw InputError(path.string(), fmt::format("others may use it (mode {:03o})", status.st_mode & 0777),
                     fmt::format("mode 600: chmod 600 {}", path.string()));
  std::string text;
  char piece[4096];
  for (;;) {
    const ssize_t got = read(file.fd, piece, sizeof piece);
    if (got < 0) fail();
    if (got == 0) return text;
    text.append(piece, static_cast<std::size_t>(got));
    if (text.size() > kMaxText) throw InputError(path.string(), "is too large", "at most 16 MiB");
  }
}

}  // namespace tessera
