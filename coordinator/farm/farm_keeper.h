// SPDX-License-Identifier: Apache-2.0
// Keeps the frames of one job in the store's journals.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/keeper.h"
#include "coordinator/store/store.h"

namespace tessera {

class FarmKeeper : public Keeper {
 public:
  // `places`: of the shot's frames in the job `number`; `identities`: of all frames' journals. `frames`: all
  // records of the job, of which those that begin are marked. `trouble` is told what the store could not do.
  // `store` and `frames` are borrowed.
  FarmKeeper(Store& store, std::uint64_t number, std::vector<std::size_t> places,
             std::vector<std::string> identities, std::vector<FrameRecord>& frames,
             std::function<void(const std::string&)> trouble);

  Begun begin(std::size_t frame, const Job&) override;
  void remembers(std::size_t frame, const std::shared_ptr<const Image>& history) override;
  void takes(std::size_t frame, Accepted&& result, const Image& pixels) override;
  void looked(std::size_t frame, const FrameUnderWay&, double seconds) override;

  // The blob of what a frame kept; empty of null. Throws StoreError.
  Digest keep(const std::shared_ptr<const Image>& history);
  // The frame has ended, as its record says. May be tried again if it throws StoreError.
  void end(std::size_t frame);
  // Whether something of a frame under way is not in its journal, as the disk was full.
  bool behind() const;

 private:
  struct Open {
    Journal journal;
    bool behind = false;  // an entry is missing: those behind it are worth nothing until the next checkpoint
  };

  std::uint32_t place(std::size_t frame) const { return static_cast<std::uint32_t>(places_[frame]); }
  Planes planes_of(const Job&);
  Begun recovered(std::size_t frame, const Job&, const Planes&);
  template <class Work>
  void write(std::size_t frame, const Work& work);

  Store& store_;
  std::uint64_t number_;
  std::vector<std::size_t> places_;
  std::vector<std::string> identities_;
  std::vector<FrameRecord>& frames_;
  std::function<void(const std::string&)> trouble_;
  std::map<std::size_t, Open> open_;
  std::shared_ptr<const Image> last_kept_;  // and its blob, which is asked for twice
  Digest last_blob_;
};

}  // namespace tessera
