// SPDX-License-Identifier: Apache-2.0
#include "bench/temporal/contestants.h"

#include <fmt/format.h>

#include <bit>
#include <charconv>

#include "core/error.h"

namespace tessera::temporal {
namespace {

// At one sample a frame the samples tell no variance: spatial. Those that need variances of samples take
// part when they are asked for, as nfor@8.
constexpr const char* kFilters[] = {
    "none",
    "atrous",
    "guided",
    "svgf:variance=spatial",
    "bmfr",
    "atrous:history=on",
    "svgf:variance=spatial,history=on",
    "bmfr:history=on",
    "bmfr:history=on,block=16",
    "atrous:history=on,taa=on",
    "svgf:variance=spatial,history=on,taa=on",
    "bmfr:history=on,taa=on",
    "bmfr:history=on,taa=on,block=16",
};

// One set after the other, as in Koskela et al. 2019, figures 5 and 6; then the set that they take, and a
// feature of figure 12.
struct Features {
  const char* parameters;
  int count;
};
constexpr Features kFeatures[] = {
    {"normals=off,positions=off", 1},
    {"normals=on,positions=off", 4},
    {"normals=on,positions=on", 7},
    {"normals=on,positions=on,gradients=on", 9},
    {"normals=squared,positions=on,gradients=on", 12},
    {"normals=squared,positions=squared,gradients=on", 15},
    {"normals=on,positions=squared", 10},
    {"normals=on,positions=squared,material=on", 11},
};

void add(std::vector<Contestant>& to, const std::string& group, const std::string& filter, int samples,
         int x) {
  Contestant c = parse_contestant(filter, samples);
  c.group = group;
  c.x = x;
  to.push_back(c);
}

}  // namespace

Contestant parse_contestant(const std::string& text, int samples) {
  Contestant c{.group = "filters", .name = text, .filter = text, .samples = samples};
  if (const std::size_t at = text.find('@'); at != std::string::npos) {
    c.filter = text.substr(0, at);
    c.samples = 0;
    std::from_chars(text.data() + at + 1, text.data() + text.size(), c.samples);
    if (c.samples < 1 || !std::has_single_bit(static_cast<unsigned>(c.samples)))
      throw Error(ExitCode::bad_usage, text + ": the samples behind @ are no power of two");
  }
  parse_filter(c.filter);
  return c;
}

std::vector<Contestant> standard_contestants(const std::string& group, int samples) {
  std::vector<Contestant> all;
  if (group == "filters")
    for (const char* text : kFilters) all.push_back(parse_contestant(text, samples));
  if (group == "features")
    for (const Features& f : kFeatures)
      add(all, group, std::string("bmfr:history=on,") + f.parameters, samples, f.count);
  if (group == "blocks")
    for (int edge = 8; edge <= 64; edge *= 2)
      add(all, group, fmt::format("bmfr:history=on,block={}", edge), samples, edge);
  return all;
}

}  // namespace tessera::temporal
