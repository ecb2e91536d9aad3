// SPDX-License-Identifier: Apache-2.0
// A coordinator's memory: a folder that survives `kill -9` at any instant. Jobs, frames, events and accepted
// tasks are rows of a database; files are blobs; results of frames under way are journals. One coordinator at
// a time, one thread.
//
//   lock   store.sqlite (-wal)   blobs/ uploads/ damaged/   frames/<job>-<place>/
//
// Each method is one transaction, unless a Transaction groups several. All throw StoreFull or StoreError,
// leaving the store as it was before the call, or before the Transaction.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/store/blob_store.h"
#include "coordinator/store/error.h"
#include "coordinator/store/journal.h"
#include "coordinator/store/records.h"

namespace tessera {

class Database;
class LockFile;

class Store {
 public:
  // Makes the folder if it is not there. Throws Error(bad_usage) if another process has it, StoreDamaged if
  // the database is damaged, and StoreError (bad_input) if it is none of ours, or of a later version.
  Store(std::filesystem::path folder, BlobOptions options = {});
  ~Store();

  BlobStore& blobs() { return blobs_; }
  const BlobStore& blobs() const { return blobs_; }
  const std::filesystem::path& folder() const { return folder_; }

  // Several calls as one: all of them count, or, unless commit() is reached, none; but for blobs and
  // journals, which are not in the database. Not nested.
  class Transaction {
   public:
    explicit Transaction(Store& store);
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    ~Transaction();
    void commit();

   private:
    Store& store_;
    bool open_ = true;
  };

  // --- Jobs. ---

  struct Added {
    JobRecord job;
    bool fresh = false;  // it was not there before
  };
  // `blobs`: all that the job needs besides its submission; they are kept as long as it. A job that is there
  // already, of the same submission and owner, is left as it is; another one of that name throws
  // Error(bad_usage).
  Added add(const JobRecord& job, std::span<const FrameRecord> frames, std::span<const Digest> blobs);
  std::optional<JobRecord> job(const JobName& job);
  std::vector<JobRecord> jobs(std::uint64_t after, std::size_t most);  // numbers above `after`, ascending
  std::vector<JobRecord> unfinished_jobs();                            // queued, active, paused
  void save(const JobRecord& job);
  // And all that is kept of it, but blobs: see collect().
  void remove(std::uint64_t job);

  // --- Frames. `job`: JobRecord::number. ---

  std::vector<FrameRecord> frames(std::uint64_t job, std::uint32_t from, std::size_t most);  // by place
  void save(std::uint64_t job, const FrameRecord& frame);
  struct FrameCounts {
    std::uint32_t all = 0, done = 0, failed = 0;  // done: there is an image
  };
  FrameCounts count_frames(std::uint64_t job);

  // --- Events. ---

  std::uint64_t add_event(std::uint64_t job, std::int64_t when, std::string_view text);  // its number
  std::vector<JobEvent> events(std::uint64_t job, std::uint64_t after, std::size_t most);

  // --- Frames under way. ---

  Journal journal(std::uint64_t job, std::uint32_t place, const std::string& identity);
  // At the begin of a round (see Journal::checkpoint_due): the journal begins anew from `checkpoint`.
  void checkpoint(std::uint64_t job, std::uint32_t place, Journal& journal, const Checkpoint& checkpoint);
  // The frame has ended: `frame` says how. Its journal goes.
  void finish(std::uint64_t job, const FrameRecord& frame, Journal journal);
  // The frame begins anew, or is not to be gone on with; its accepted tasks go, too.
  void drop_journal(std::uint64_t job, std::uint32_t place);
  // Journals of frames that are not active, left by a coordinator that was killed as one ended.
  void drop_stale_journals();

  // --- Accepted tasks: of ended frames, and of frames under way those before their last checkpoint. ---

  std::uint64_t accepted_count(std::uint64_t job);
  std::optional<AcceptedRecord> accepted_at(std::uint64_t job, std::uint64_t index);  // 0..count

  // Removes blobs that no job needs and that were last used before `before` (Unix time, ms). Returns the
  // bytes that became free.
  std::uint64_t collect(std::int64_t before);

 private:
  std::filesystem::path journal_folder(std::uint64_t job, std::uint32_t place) const;
  bool is_active(std::uint64_t job, std::uint32_t place);
  void add_accepted(std::uint64_t job, std::uint32_t place, const Journal& journal);

  std::filesystem::path folder_;
  std::unique_ptr<LockFile> lock_;
  std::unique_ptr<Database> database_;
  BlobStore blobs_;
};

}  // namespace tessera
