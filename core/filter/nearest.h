// SPDX-License-Identifier: Apache-2.0
// The name that was probably meant.
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace tessera {

// The name with the fewest typing slips (insert, delete, replace, swap of neighbours) from `word`, if it is
// near enough to be worth suggesting: at most a third of the longer one's letters, and at least one allowed.
std::optional<std::string_view> nearest(std::string_view word, std::span<const std::string_view> names);

}  // namespace tessera
