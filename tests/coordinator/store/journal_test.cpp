// SPDX-License-Identifier: Apache-2.0
#include "coordinator/store/journal.h"

#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "coordinator/store/error.h"
#include "tests/coordinator/store/folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

Image numbered_image(int number) {
  Image image({0, 0, 16, 8}, 3);
  float value = static_cast<float>(number);
  for (float& v : image.data()) v = value += 0.5f;
  return image;
}

Accepted numbered(int number) {
  Accepted accepted{
      RenderTask{{0, 0, 16, 8}, {8 * number, 8 * number + 8}}, 1, {}, "worker-1", "class", 0.5, 3};
  if (number % 2 == 1) accepted.work = FilterTask{{{0, 0, 16, 8}, {0, 0, 20, 10}}, number};
  return accepted;
}

void append(Journal& journal, int number) {
  Accepted accepted = numbered(number);
  journal.append(accepted, numbered_image(number));
}

// The numbers of the entries, each found to be as it was written.
std::vector<int> numbers_in(Journal& journal) {
  std::vector<int> numbers;
  journal.replay([&](const LoggedEvent& logged) {
    const Accepted& found = std::get<Accepted>(logged.event);
    const int number = static_cast<int>(logged.pixels.at(0, 0, 0));
    Accepted expected = numbered(number);
    expected.digest = found.digest;
    EXPECT_EQ(found, expected);
    EXPECT_EQ(logged.pixels, numbered_image(number));
    numbers.push_back(number);
    return true;
  });
  return numbers;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_bytes(const fs::path& file, std::string_view bytes) {
  fs::remove(file);  // file systems are slow to empty what is there
  std::ofstream(file, std::ios::binary) << bytes;
}

Checkpoint sample_checkpoint(int round) {
  Checkpoint c;
  c.frame.round = round;
  c.frame.have = {16, 32};
  c.frame.want = {32, 32};
  c.frame.looks = {{16, {0.25, 0.125}, ErrorEstimate{0.5, 0.0625}, Guard::heavy_tails}, {32, {1, 2}, {}, {}}};
  c.frame.states = {{CellStatus::open, 16, 1, {0.25, 0.125}, Guard::too_dark},
                    {CellStatus::accepted, 32, 2, {1, 2}, Guard::none}};
  c.frame.error = {0.75, 0.5};
  c.frame.acceptable_share = 0.5;
  c.frame.sums = numbered_image(7);
  c.frame.stitched = numbered_image(9);
  c.seconds = 12.5;
  c.dropped = 4;
  c.device_classes = {"class", "other"};
  c.errors = {0.5f, 0.75f};
  return c;
}

void expect_same(const Checkpoint& a, const Checkpoint& b) {
  EXPECT_EQ(a.frame.round, b.frame.round);
  EXPECT_EQ(a.frame.have, b.frame.have);
  EXPECT_EQ(a.frame.want, b.frame.want);
  EXPECT_EQ(a.frame.states, b.frame.states);
  ASSERT_EQ(a.frame.looks.size(), b.frame.looks.size());
  for (std::size_t i = 0; i < a.frame.looks.size(); ++i) {
    EXPECT_EQ(a.frame.looks[i].samples, b.frame.looks[i].samples);
    EXPECT_EQ(a.frame.looks[i].error, b.frame.looks[i].error);
    EXPECT_EQ(a.frame.looks[i].hold_out, b.frame.looks[i].hold_out);
    EXPECT_EQ(a.frame.looks[i].guard, b.frame.looks[i].guard);
  }
  EXPECT_EQ(a.frame.error, b.frame.error);
  EXPECT_EQ(a.frame.acceptable_share, b.frame.acceptable_share);
  EXPECT_TRUE(same_bits(a.frame.sums, b.frame.sums));
  EXPECT_TRUE(same_bits(a.frame.stitched, b.frame.stitched));
  EXPECT_EQ(a.seconds, b.seconds);
  EXPECT_EQ(a.dropped, b.dropped);
  EXPECT_EQ(a.device_classes, b.device_classes);
  EXPECT_EQ(a.errors, b.errors);
}

TEST(Journal, GivesBackItsEntriesInOrder) {
  Folder folder;
  {
    Journal journal(folder.path(), "frame");
    EXPECT_FALSE(journal.found().any);
    for (int i = 0; i < 5; ++i) append(journal, i);
  }
  Journal journal(folder.path(), "frame");
  EXPECT_TRUE(journal.found().any);
  EXPECT_EQ(journal.found().thrown_away, "");
  EXPECT_EQ(numbers_in(journal), (std::vector{0, 1, 2, 3, 4}));
  std::vector<Accepted> accepted;
  journal.each_accepted(
      [&](std::string_view header) { accepted.push_back(std::get<Accepted>(event_of(header))); });
  ASSERT_EQ(accepted.size(), 5u);
  EXPECT_EQ(accepted[3].work, numbered(3).work);
  EXPECT_TRUE(is_digest(accepted[3].digest));
  EXPECT_FALSE(journal.checkpoint());
}

TEST(Journal, CutAnywhereGivesBackTheEntriesBeforeThat) {
  Folder folder;
  std::vector<std::uint64_t> ends;
  {
    Journal journal(folder.path(), "frame");
    ends.push_back(journal.bytes());
    for (int i = 0; i < 3; ++i) {
      append(journal, i);
      ends.push_back(journal.bytes());
    }
  }
  const std::string whole = bytes_of(folder.path() / "0.journal");
  ASSERT_EQ(whole.size(), ends.back());
  for (std::size_t length = 0; length <= whole.size(); length += 7) {
    write_bytes(folder.path() / "0.journal", std::string_view(whole).substr(0, length));
    Journal journal(folder.path(), "frame");
    const std::size_t entries = std::ranges::count_if(ends, [&](std::uint64_t end) { return end <= length; });
    ASSERT_EQ(numbers_in(journal).size(), entries == 0 ? 0 : entries - 1) << length;
    append(journal, 9);
    EXPECT_EQ(numbers_in(journal).back(), 9);
  }
}

TEST(Journal, ADamagedByteCostsItsEntryAndThoseBehindItAndThatIsSaid) {
  Folder folder;
  std::vector<std::uint64_t> ends;
  {
    Journal journal(folder.path(), "frame");
    ends.push_back(journal.bytes());
    for (int i = 0; i < 3; ++i) {
      append(journal, i);
      ends.push_back(journal.bytes());
    }
  }
  const std::string whole = bytes_of(folder.path() / "0.journal");
  for (std::size_t at = 0; at < whole.size(); at += 11) {
    std::string damaged = whole;
    damaged[at] ^= 0x10;
    write_bytes(folder.path() / "0.journal", damaged);
    Journal journal(folder.path(), "frame");
    const std::size_t sound = std::ranges::count_if(ends, [&](std::uint64_t end) { return end <= at; });
    ASSERT_EQ(numbers_in(journal).size(), sound == 0 ? 0 : sound - 1) << at;
    EXPECT_NE(journal.found().thrown_away, "") << at;
  }
}

TEST(Journal, OfAnotherIdentityIsThrownAwayAndThatIsSaid) {
  Folder folder;
  {
    Journal journal(folder.path(), "frame");
    append(journal, 1);
  }
  Journal journal(folder.path(), "frame, next version");
  EXPECT_FALSE(journal.found().any);
  EXPECT_NE(journal.found().thrown_away, "");
  EXPECT_TRUE(numbers_in(journal).empty());
}

TEST(Journal, RestartsFromACheckpointAndHandsOnWhatTheFrameBeforeKept) {
  Folder folder;
  const Remembered history{sha256("history")};
  {
    Journal journal(folder.path(), "frame");
    journal.append(history);
    for (int i = 0; i < 5; ++i) append(journal, i);
    const std::uint64_t before = journal.bytes();
    journal.restart(sample_checkpoint(3));
    EXPECT_LT(journal.bytes(), before);
    append(journal, 6);
    journal.restart(sample_checkpoint(4));
    append(journal, 8);
  }
  Journal journal(folder.path(), "frame");
  EXPECT_TRUE(journal.found().any);
  ASSERT_TRUE(journal.checkpoint());
  expect_same(*journal.checkpoint(), sample_checkpoint(4));
  std::vector<FrameEvent> events;
  journal.replay([&](const LoggedEvent& logged) {
    events.push_back(logged.event);
    return true;
  });
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(std::get<Remembered>(events[0]), history);
  EXPECT_EQ(std::get<Accepted>(events[1]).work, numbered(8).work);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2) << "old files stay";
}

TEST(Journal, ARestartThatWasNotFinishedCountsOnlyOnceItsCheckpointIsThere) {
  Folder folder;
  std::string journal0, journal1, checkpoint1;
  {
    Journal journal(folder.path(), "frame");
    append(journal, 1);
    journal0 = bytes_of(folder.path() / "0.journal");
    journal.restart(sample_checkpoint(3));
    journal1 = bytes_of(folder.path() / "1.journal");
    checkpoint1 = bytes_of(folder.path() / "1.checkpoint");
  }
  const auto opened = [&](std::optional<std::string> journal, std::optional<std::string> aside,
                          std::optional<std::string> checkpoint) {
    fs::remove_all(folder.path());
    fs::create_directory(folder.path());
    write_bytes(folder.path() / "0.journal", journal0);
    if (journal) write_bytes(folder.path() / "1.journal", *journal);
    if (aside) write_bytes(folder.path() / "1.checkpoint.new", *aside);
    if (checkpoint) write_bytes(folder.path() / "1.checkpoint", *checkpoint);
    Journal found(folder.path(), "frame");
    return std::pair(found.checkpoint().has_value(), numbers_in(found).size());
  };
  const std::pair before(false, std::size_t{1}), after(true, std::size_t{0});
  EXPECT_EQ(opened(journal1.substr(0, 20), {}, {}), before);
  EXPECT_EQ(opened(journal1, {}, {}), before);
  EXPECT_EQ(opened(journal1, checkpoint1.substr(0, 100), {}), before);
  EXPECT_EQ(opened(journal1, checkpoint1, {}), before);
  EXPECT_EQ(opened(journal1, {}, checkpoint1), after);
  std::string damaged = checkpoint1;
  damaged.back() ^= 1;
  EXPECT_EQ(opened(journal1, {}, damaged), before);
}

TEST(Journal, IsWorthACheckpointWhenItIsMuchLongerThanThat) {
  Folder folder;
  Journal journal(folder.path(), "frame");
  Accepted accepted = numbered(0);
  const Image large({0, 0, 1024, 1024}, 5);  // 20 MB
  journal.append(accepted, large);
  EXPECT_FALSE(journal.checkpoint_due(1)) << "too little to be worth it";
  journal.append(accepted, large);
  EXPECT_TRUE(journal.checkpoint_due(1));
  EXPECT_FALSE(journal.checkpoint_due(25e6));
}

}  // namespace
}  // namespace tessera
