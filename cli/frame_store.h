// SPDX-License-Identifier: Apache-2.0
// Images of frames put aside on disk: in one file without a name, which vanishes with the process whatever
// ends it.
#pragma once

#include <filesystem>
#include <map>

#include "core/image.h"

namespace tessera {

class FrameStore {
 public:
  // The file lies on the disk of `folder`. Throws InputError if there can be none.
  explicit FrameStore(const std::filesystem::path& folder);
  FrameStore(const FrameStore&) = delete;
  FrameStore& operator=(const FrameStore&) = delete;
  ~FrameStore();

  // Throw InputError if the disk is full or fails.
  void put(int number, const Image&);
  // Empty if there is none of that number.
  Image get(int number) const;

 private:
  struct Place {
    std::int64_t begin = 0;
    Region region;
    int planes = 0;
  };

  std::filesystem::path folder_;
  int file_ = -1;
  std::int64_t end_ = 0;
  std::map<int, Place> places_;
};

}  // namespace tessera
