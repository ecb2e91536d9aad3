// SPDX-License-Identifier: Apache-2.0
// What is left to do of a shot of which some frames are there already. Pure.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/job.h"

namespace tessera {

// Equal keys: equal images, whatever they are made on and in what tiles. `before`: the key of the frame whose
// history it goes by; empty: of none.
std::string image_key(const Job& job, std::string_view before);

// The keys of all frames, each continuing the one before where it does (see shot.h).
std::vector<std::string> image_keys(const std::vector<Job>& frames);

// The key of the image that did come of a frame. `keys`: as image_keys() says, but those of frames before it
// that have ended as this says. `continued`: it went by what the frame before has kept, and not, as that one
// failed, by nothing. Without the break in its key, resuming would take an image behind it for the right one.
std::string key_as_made(const std::vector<Job>& frames, const std::vector<std::string>& keys,
                        std::size_t frame, bool continued);

struct Remaining {
  std::vector<std::size_t> frames;     // still to be done, ascending
  std::vector<std::size_t> from_kept;  // of them, those that go by what is kept in a file
};

// `done[i]`: the image of keys[i] is there. `kept`: the key of the frame whose history is there; empty: of
// none. A frame whose history is gone takes those along that lead up to it, as far as one that needs none.
Remaining remaining(const std::vector<Job>& frames, const std::vector<std::string>& keys,
                    const std::vector<bool>& done, std::string_view kept);

}  // namespace tessera
