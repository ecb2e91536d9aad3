// SPDX-License-Identifier: Apache-2.0
#include "cli/frame_store.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "core/error.h"

namespace tessera {
namespace {

// Reads or writes all of it, however many calls that takes; `call` is pread or pwrite.
template <typename Byte, typename Call>
bool transferred(Call call, int file, Byte* bytes, std::size_t size, std::int64_t at) {
  while (size > 0) {
    const ssize_t done = call(file, bytes, size, at);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    bytes += done;
    at += done;
    size -= static_cast<std::size_t>(done);
  }
  return true;
}

}  // namespace

FrameStore::FrameStore(const std::filesystem::path& folder) : folder_(folder.empty() ? "." : folder) {
  std::string name = (folder_ / ".tessera-backwards-XXXXXX").string();
  file_ = ::mkstemp(name.data());
  if (file_ < 0)
    throw InputError(folder_.string(), std::strerror(errno), "a folder in which files can be written");
  ::unlink(name.c_str());
}

FrameStore::~FrameStore() { ::close(file_); }

void FrameStore::put(int number, const Image& image) {
  const std::span<const float> data = image.data();
  errno = ENOSPC;  // where a write ends early without a reason
  if (!transferred(::pwrite, file_, reinterpret_cast<const char*>(data.data()), data.size_bytes(), end_))
    throw InputError(folder_.string(), std::strerror(errno),
                     "a disk with room for what --both-ways puts aside");
  places_[number] = {end_, image.region(), image.planes()};
  end_ += static_cast<std::int64_t>(data.size_bytes());
}

Image FrameStore::get(int number) const {
  const auto at = places_.find(number);
  if (at == places_.end()) return {};
  Image image(at->second.region, at->second.planes);
  const std::span<float> data = image.data();
  errno = EIO;
  if (!transferred(::pread, file_, reinterpret_cast<char*>(data.data()), data.size_bytes(), at->second.begin))
    throw InputError(folder_.string(), std::strerror(errno), "a disk that can be read");
  return image;
}

}  // namespace tessera
