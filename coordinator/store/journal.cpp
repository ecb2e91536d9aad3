// SPDX-License-Identifier: Apache-2.0
#include "coordinator/store/journal.h"

#include <fmt/format.h>

#include <array>
#include <charconv>

#include "coordinator/store/error.h"
#include "coordinator/store/record_file.h"
#include "proto/codec.h"

namespace tessera {
namespace {

constexpr double kLeastBytes = 32 << 20;  // of a journal that is worth a checkpoint

// The number in "12.journal" or "12.checkpoint".
std::optional<int> number_of(const std::filesystem::path& file) {
  const std::string name = file.filename();
  int number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  const std::string_view rest(end, name.data() + name.size());
  const bool ours = error == std::errc() && number >= 0 && (rest == ".journal" || rest == ".checkpoint");
  return ours ? std::optional(number) : std::nullopt;
}

std::set<int, std::greater<>> numbers_in(const std::filesystem::path& folder) {
  std::set<int, std::greater<>> numbers;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (const auto number = number_of(entry.path())) numbers.insert(*number);
  return numbers;
}

// The first record of a file, if it is of this identity.
std::optional<StoredRecord> identified(const OpenFile& file, const std::string& identity) {
  auto record = read_record(file, 0);
  if (!record || !is_sound(file, *record) || record->header != identity) return std::nullopt;
  return record;
}

std::uint64_t write_identity(OpenFile& file, const std::string& identity) {
  return write_record(file, 0, identity, {}, sha256(""));
}

}  // namespace

Journal::Journal(std::filesystem::path folder, std::string identity)
    : folder_(std::move(folder)), identity_(std::move(identity)) {
  make_folder(folder_);
  open_highest();
  remove_others();
}

std::filesystem::path Journal::path(int number, std::string_view kind) const {
  return folder_ / fmt::format("{}.{}", number, kind);
}

void Journal::open_highest() {
  const auto numbers = numbers_in(folder_);
  for (const int number : numbers)
    if (open(number)) return;
  if (!numbers.empty() && found_.thrown_away.empty())
    found_.thrown_away = "all of it: it is damaged, or of another job or version";
  remove_files(path(0, "journal"));
  create(0, {});
}

bool Journal::open(int number) {
  const bool begun = number == 0;
  if (!std::filesystem::exists(path(number, "journal"))) return false;
  if (!begun && !sound_checkpoint(number)) return false;
  OpenFile file(path(number, "journal"), OpenFile::Mode::write);
  const auto first = identified(file, identity_);
  if (!first) return false;
  file_ = std::move(file);
  number_ = number;
  begin_ = first->end();
  find_end();
  found_.any = !begun || end_ > begin_;
  return true;
}

bool Journal::sound_checkpoint(int number) const {
  if (!std::filesystem::exists(path(number, "checkpoint"))) return false;
  const OpenFile file(path(number, "checkpoint"), OpenFile::Mode::read);
  const auto first = identified(file, identity_);
  const auto second = first ? read_record(file, first->end()) : std::nullopt;
  return second && is_sound(file, *second);
}

// Cuts off what is not whole.
void Journal::find_end() {
  end_ = begin_;
  while (const auto record = read_record(file_, end_)) {
    if (!is_sound(file_, *record) || !note(*record)) break;
    end_ = record->end();
  }
  const std::uint64_t size = file_.size();
  if (size == end_) return;
  found_.thrown_away = fmt::format("the last {} bytes: they are not whole", size - end_);
  file_.truncate(end_);
}

// What the frame before kept is handed on to the next journal. False: it says nothing that is understood.
bool Journal::note(const StoredRecord& record) {
  try {
    const FrameEvent event = event_of(record.header);
    if (const auto* remembered = std::get_if<Remembered>(&event)) remembered_ = *remembered;
    return true;
  } catch (const ProtocolError&) {
    return false;
  }
}

void Journal::create(int number, const std::optional<Remembered>& remembered) {
  OpenFile file(path(number, "journal"), OpenFile::Mode::create);
  const std::uint64_t begin = write_identity(file, identity_);
  std::uint64_t end = begin;
  if (remembered) end = write_record(file, begin, header_of(*remembered, {}), {}, sha256(""));
  file_ = std::move(file);
  number_ = number;
  begin_ = begin;
  end_ = end;
}

// One that stays is only in the way: it is tried again when the journal is opened.
void Journal::remove_others() const {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    if (number_of(entry.path()) != number_) std::filesystem::remove_all(entry.path(), ignored);
}

std::optional<Checkpoint> Journal::checkpoint() const {
  if (number_ == 0) return std::nullopt;
  const OpenFile file(path(number_, "checkpoint"), OpenFile::Mode::read);
  const auto first = identified(file, identity_);
  const auto record = first ? read_record(file, first->end()) : std::nullopt;
  if (!record) throw StoreDamaged(file.path(), "is not what it was");
  Checkpoint checkpoint = checkpoint_from(record->header, record->plane_bytes);
  FrameSnapshot& frame = checkpoint.frame;
  read_planes(file, record->planes_at, frame.sums.data());
  read_planes(file, record->planes_at + frame.sums.data().size_bytes(), frame.stitched.data());
  return checkpoint;
}

void Journal::replay(const std::function<bool(LoggedEvent)>& visit) {
  for (std::uint64_t at = begin_; at < end_;) {
    const auto record = read_record(file_, at);
    if (!record) throw StoreDamaged(file_.path(), "is not what it was");
    LoggedEvent logged = event_from(record->header, record->plane_bytes);
    read_planes(file_, record->planes_at, logged.pixels.data());
    if (!visit(std::move(logged))) {
      found_.thrown_away = fmt::format("the last {} bytes: they are not of what is planned now", end_ - at);
      file_.truncate(at);
      end_ = at;
      return;
    }
    at = record->end();
  }
}

void Journal::append(Accepted& event, const Image& pixels) {
  const std::array<Bytes, 1> planes{std::as_bytes(pixels.data())};
  event.digest = digest_of(planes);
  end_ = write_record(file_, end_, header_of(event, pixels), planes, event.digest);
}

void Journal::append(const Remembered& event) {
  end_ = write_record(file_, end_, header_of(event, {}), {}, sha256(""));
  remembered_ = event;
}

void Journal::append(const Looked& event) {
  end_ = write_record(file_, end_, header_of(event, {}), {}, sha256(""));
}

bool Journal::checkpoint_due(double bytes) const {
  return static_cast<double>(end_ - begin_) > std::max(2 * bytes, kLeastBytes);
}

void Journal::restart(const Checkpoint& checkpoint) {
  const int next = number_ + 1;
  const auto aside = path(next, "checkpoint.new");
  OpenFile old = std::move(file_);
  const std::array before{begin_, end_};
  try {
    for (const auto& left : {path(next, "journal"), aside}) remove_files(left);
    create(next, remembered_);
    OpenFile file(aside, OpenFile::Mode::create);
    const FrameSnapshot& frame = checkpoint.frame;
    const std::array<Bytes, 2> planes{std::as_bytes(frame.sums.data()), std::as_bytes(frame.stitched.data())};
    write_record(file, write_identity(file, identity_), header_of(checkpoint), planes, digest_of(planes));
    move_file(aside, path(next, "checkpoint"), false);  // from here on the new ones count
  } catch (...) {
    file_ = std::move(old);
    number_ = next - 1;
    begin_ = before[0], end_ = before[1];
    std::error_code ignored;
    for (const auto& left : {path(next, "journal"), aside}) std::filesystem::remove(left, ignored);
    throw;
  }
  remove_others();
}

void Journal::each_accepted(const std::function<void(std::string_view)>& visit) const {
  for (std::uint64_t at = begin_; at < end_;) {
    const auto record = read_record(file_, at);
    if (!record) throw StoreDamaged(file_.path(), "is not what it was");
    if (record->plane_bytes > 0) visit(record->header);
    at = record->end();
  }
}

}  // namespace tessera
