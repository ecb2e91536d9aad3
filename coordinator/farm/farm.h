// SPDX-License-Identifier: Apache-2.0
// A coordinator as a service: many jobs, handed in by message, kept in a store, that survive everything but
// the loss of the store. One thread, beside the clerk's.
//
// A full disk stops the work, and loses none: no task is given out, nothing is taken in, and it goes on by
// itself as soon as there is room (see trouble()).
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "coordinator/coordinator.h"
#include "coordinator/farm/clerk.h"
#include "coordinator/farm/farm_keeper.h"
#include "coordinator/farm/figures.h"
#include "coordinator/farm/open_job.h"
#include "coordinator/farm/previews.h"
#include "coordinator/queue.h"
#include "coordinator/store/store.h"

namespace tessera {

struct FarmOptions {
  CoordinatorOptions coordinator = {};
  std::filesystem::path store;
  BlobOptions blobs = {};
  double memory = 0;                     // bytes that the frames under way may take
  std::string version;                   // of tessera
  Millis keep_unused{24 * 3600 * 1000};  // blobs that no job needs, since their last use
  // Told once a second how things stand, and whenever trouble begins or ends.
  std::function<void(FarmFigures)> publish = {};
};

class Farm {
 public:
  // `road` is borrowed. Throws what Store throws.
  Farm(Transport& road, FarmOptions options);
  ~Farm();

  // Works until stop(). Everything is kept: the next farm on the store goes on where this one was.
  void run();
  void stop();  // from any thread
  // One turn of the loop: for those who have a loop of their own.
  void turn(Instant until);

  // --- What commands may do; the desk sees to it that they may. All throw Error. ---

  // `highest`: the priority that the owner may ask for; more is cut down to it.
  void submit(const JobName& name, const Digest& submission, const std::string& owner, int highest);
  void cancel(const JobName& name, const std::string& by);
  void pause(const JobName& name);
  void resume(const JobName& name);
  void set_priority(const JobName& name, int priority);
  // Has so many of its accepted tasks done again by other workers; what comes of it is told as events.
  void verify(const JobName& name, int tasks, std::uint64_t seed);
  // One that is over, and that no other waits for; its images go as soon as they were not used for a while.
  void remove(const JobName& name);
  void release(const std::string& worker) { coordinator_.release(worker); }

  JobRecord record(const JobName& name);  // throws Error(bad_input) if there is none
  JobSummary summary(const JobRecord& record);
  std::uint64_t stamp(const JobName& name) const;  // see JobDetail
  // `previews`: somebody wants those of frames under way.
  std::vector<FrameSummary> frames(const JobRecord& record, std::uint32_t from, std::size_t most,
                                   bool previews);

  // Of a frame under way; null: there is none by that digest.
  Previews::Png preview(const Digest& digest) const { return previews_.find(digest); }

  Store& store() { return store_; }
  const Coordinator& coordinator() const { return coordinator_; }
  const Queue& queue() const { return queue_; }
  const std::map<JobName, OpenJob>& open_jobs() const { return open_; }
  double memory_free() const;
  // Tasks that were done again, and came out otherwise.
  std::uint64_t wrong_bits() const { return wrong_bits_; }
  FarmFigures figures(Instant now) const;  // but for the road's
  // Why nothing goes on; empty: it does.
  const std::string& trouble() const { return trouble_; }

 private:
  CoordinatorOptions prepared(CoordinatorOptions options);
  void recover();
  void open(const JobRecord& record);
  void begin_jobs();
  void begin(OpenJob& job);
  StillToDo look_for_work(OpenJob& job, std::map<std::size_t, std::shared_ptr<const Image>>& histories);
  void ended(const JobName& name, std::size_t frame, JobReport report);
  void file_next();
  void file_as(Digest& blob, const Written::File& file);
  void settle(OpenJob& job, std::size_t place);
  void save(OpenJob& job);
  void changed(OpenJob& job);
  void collect();
  void file_failed(OpenJob& job, std::size_t place, const JobReport& report);
  void look_at_files(const OpenJob& job, const std::string& reason);
  void keep_limits();
  void end_jobs();
  void end(OpenJob& job, JobState how, const std::string& reason);
  void forget_if_alone(const JobName& name);
  std::optional<JobName> comes_before(const JobName& name) const;  // an open job that waits for this one
  void note(const OpenJob& job, const std::string& text) { note(job.record.number, text); }
  void note(std::uint64_t job, const std::string& text);
  void have_trouble(const std::string& what);
  void look(Instant now);
  void look_at_trouble(Instant now);
  bool hungry() const;
  void publish(Instant now);
  void draw_previews(Instant now);
  void draw_preview(const Previews::Key& which, Instant now);
  JobFigures figures(const OpenJob& job) const;
  Standing standing_of(const OpenJob& job) const;
  double seconds_of(const OpenJob& job) const;
  OpenJob& open_job(const JobName& name);
  Submission submission_of(const JobRecord& record);
  void check(const JobRecord& record, const Job& job, const AcceptedRecord& task);

  FarmOptions options_;
  Store store_;
  Coordinator coordinator_;
  Queue queue_;
  std::map<JobName, OpenJob> open_;
  Previews previews_;
  Clerk clerk_;
  std::deque<Written> unfiled_;  // as the disk is full
  std::string trouble_;
  bool changed_ = true;  // something has ended, or may begin
  Instant next_look_{}, next_try_{};
  std::int64_t next_collection_ = 0;
  const Instant began_;
  Instant next_publication_{};
  std::string published_trouble_;
  std::deque<std::pair<Instant, std::uint64_t>> samples_;  // at publications of the last seconds
  std::array<std::uint64_t, kJobStates> ended_jobs_{};     // by how
  std::uint64_t wrong_bits_ = 0;
  std::atomic<bool> stopped_ = false;
};

}  // namespace tessera
