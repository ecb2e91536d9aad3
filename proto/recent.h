// SPDX-License-Identifier: Apache-2.0
// A table of the names used most recently, of bounded size. It keeps two generations: names not used while a
// whole generation filled up are forgotten.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace tessera {

template <class T>
class Recent {
 public:
  // At most `size` names are kept, and the last size / 2 of them for certain.
  explicit Recent(std::size_t size) : half_(size < 2 ? 1 : size / 2) {}

  // The value of a name that is known, or null. It stays valid until the next at().
  T* find(std::string_view name) {
    if (const auto it = young_.find(name); it != young_.end()) return &it->second;
    const auto it = old_.find(name);
    return it == old_.end() ? nullptr : &it->second;
  }

  // The value of a name, which is default-constructed if it is not known; it is now the most recent.
  T& at(std::string_view name) {
    if (const auto it = young_.find(name); it != young_.end()) return it->second;
    const auto it = old_.find(name);
    auto known = it == old_.end() ? typename Table::node_type() : old_.extract(it);
    if (young_.size() >= half_) old_ = std::exchange(young_, {});
    if (known.empty()) return young_[std::string(name)];
    return young_.insert(std::move(known)).position->second;
  }

  std::size_t size() const { return young_.size() + old_.size(); }

 private:
  struct Hash {
    using is_transparent = void;
    std::size_t operator()(std::string_view s) const { return std::hash<std::string_view>()(s); }
  };
  using Table = std::unordered_map<std::string, T, Hash, std::equal_to<>>;
  std::size_t half_;
  Table young_, old_;
};

}  // namespace tessera
