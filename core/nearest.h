// SPDX-License-Identifier: Apache-2.0
// What someone who mistyped a name probably meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tessera {

// The name among `known` with the fewest typing slips (insert, delete, replace, swap of neighbours; not case)
// from `name`; empty if even that takes more than half of its letters.
std::string_view nearest(std::string_view name, std::span<const std::string_view> known);

// "unknown WHAT 'NAME'", and "; did you mean 'NEAREST'?" if there is one.
std::string unknown(std::string_view what, std::string_view name, std::span<const std::string_view> known);

// The names, comma separated; beyond a dozen, the first of them and how many more.
std::string listed(std::span<const std::string_view> names);

}  // namespace tessera
