// SPDX-License-Identifier: Apache-2.0
// What happened to a frame under way, written down before it is acted on, so that a coordinator that is
// killed at any instant goes on where it was. A folder of its own:
//
//   <n>.checkpoint   the frame as it was before the entries of <n>.journal; none: it had just begun
//   <n>.journal      entries, each with its length and checksum; a torn or damaged tail is cut off on opening
//
// The highest <n> with a sound checkpoint counts. Entries are in the hands of the system when append()
// returns: killing the process loses none. A power cut may cost the last ones, or the frame's progress, never
// its bits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/store/file.h"
#include "coordinator/store/record_file.h"
#include "proto/frame_codec.h"
#include "proto/frame_log.h"

namespace tessera {

class Journal {
 public:
  // Opens or creates it. `identity`: of what is made and by what (the frame's key, the version): a journal of
  // another identity is thrown away. At most 4096 bytes.
  Journal(std::filesystem::path folder, std::string identity);

  // What was found on opening.
  struct Found {
    bool any = false;         // there is a checkpoint or an entry: else the frame begins anew
    std::string thrown_away;  // what of it was not sound, and why; empty: nothing
  };
  const Found& found() const { return found_; }

  // Reads the checkpoint; none: the frame had just begun.
  std::optional<Checkpoint> checkpoint() const;
  // Calls `visit` for each entry, in order. If it returns false, that entry and all behind it are cut off.
  void replay(const std::function<bool(LoggedEvent)>& visit);

  // Writes an entry, before it is acted on. Throws StoreFull or StoreError, and the journal is as before. Of
  // Accepted, `digest` is filled in.
  void append(Accepted& event, const Image& pixels);
  void append(const Remembered& event);
  void append(const Looked& event);

  // At the begin of a round: whether so much was written since the last checkpoint that another one, of about
  // `bytes`, is worth it. Then a frame takes a few times its own size on the disk however long it is worked
  // on.
  bool checkpoint_due(double bytes) const;
  // All that came before is forgotten but what the frame before kept. At once, seen from a kill.
  void restart(const Checkpoint& checkpoint);

  // Calls `visit` with event_of()'s bytes for each Accepted that is in the journal now.
  void each_accepted(const std::function<void(std::string_view)>& visit) const;

  int number() const { return number_; }        // grows with each restart
  std::uint64_t bytes() const { return end_; }  // of the journal

 private:
  void open_highest();
  bool open(int number);
  void create(int number, const std::optional<Remembered>& remembered);
  bool sound_checkpoint(int number) const;
  void find_end();
  bool note(const StoredRecord& record);
  void remove_others() const;
  std::filesystem::path path(int number, std::string_view kind) const;

  std::filesystem::path folder_;
  std::string identity_;
  int number_ = 0;
  OpenFile file_;
  std::uint64_t begin_ = 0, end_ = 0;  // of the entries
  std::optional<Remembered> remembered_;
  Found found_;
};

}  // namespace tessera
