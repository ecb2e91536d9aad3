// SPDX-License-Identifier: Apache-2.0
// The last few values that were expensive to make, by key. Several threads may ask: the first makes it, the
// others wait for that one; different keys are made at the same time.
#pragma once

#include <cassert>
#include <cstddef>
#include <functional>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <string>

namespace tessera {

template <class Value>
class LatestCache {
 public:
  using Shared = std::shared_ptr<const Value>;  // what is in use outlives its place here

  explicit LatestCache(std::size_t most) : most_(most) { assert(most > 0); }

  // What `make` throws reaches all who waited, and is not kept.
  Shared find_or_make(const std::string& key, const std::function<Shared()>& make) {
    std::promise<Shared> promise;
    std::shared_future<Shared> value;
    std::uint64_t id = 0;
    {
      const std::lock_guard lock(mutex_);
      for (auto it = entries_.begin(); it != entries_.end(); ++it)
        if (it->key == key) {
          entries_.splice(entries_.begin(), entries_, it);
          value = it->value;
          break;
        }
      if (!value.valid()) {
        id = ++made_;
        entries_.push_front({key, promise.get_future().share(), id});
        if (entries_.size() > most_) entries_.pop_back();
      }
    }
    if (id == 0) return value.get();
    return fulfil(promise, id, make);
  }

 private:
  struct Entry {
    std::string key;
    std::shared_future<Shared> value;
    std::uint64_t id;
  };

  Shared fulfil(std::promise<Shared>& promise, std::uint64_t id, const std::function<Shared()>& make) {
    try {
      Shared value = make();
      promise.set_value(value);
      return value;
    } catch (...) {
      {
        const std::lock_guard lock(mutex_);
        entries_.remove_if([id](const Entry& e) { return e.id == id; });
      }
      promise.set_exception(std::current_exception());
      throw;
    }
  }

  std::size_t most_;
  std::mutex mutex_;  // guards all below
  std::uint64_t made_ = 0;
  std::list<Entry> entries_;  // the latest used first
};

}  // namespace tessera
