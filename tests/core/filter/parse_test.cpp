// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/filter/filter.h"
#include "core/nearest.h"

namespace tessera {
namespace {

std::string complaint(std::string_view text) {
  try {
    parse_filter(text);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_usage);
    return e.what();
  }
  ADD_FAILURE() << text << " is accepted";
  return {};
}

std::string complaint(const FilterPlan& plan) {
  try {
    validate(plan);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    return e.what();
  }
  ADD_FAILURE() << plan.name << " is accepted";
  return {};
}

// Of all filters, as complaints list them.
std::string names() {
  std::string all;
  for (const FilterDescription& d : filters()) all += (all.empty() ? "" : ", ") + std::string(d.name);
  return all;
}

TEST(FilterText, NamesAFilterWithEveryParameterAtItsDefault) {
  for (const FilterDescription& d : filters()) {
    const FilterPlan plan = parse_filter(d.name);
    EXPECT_EQ(plan.name, d.name);
    EXPECT_EQ(plan.parameters.size(), d.parameters.size());
    for (const Parameter& p : d.parameters) EXPECT_EQ(plan[p.name], p.standard);
    EXPECT_EQ(to_string(plan), d.name);
    EXPECT_NO_THROW(validate(plan));
  }
}

TEST(FilterText, ComesBackAsItWasRead) {
  for (const std::string text :
       {"none", "atrous:levels=3,sigma_c=0.1", "svgf:levels=1,sigma_n=64,variance=spatial",
        "svgf:sigma_z=0.30000000000000004,sigma_l=2"}) {
    const FilterPlan plan = parse_filter(text);
    EXPECT_EQ(to_string(plan), text);
    EXPECT_EQ(parse_filter(to_string(plan)), plan);
  }
  EXPECT_EQ(to_string(parse_filter("svgf:variance=samples,levels=5,sigma_n=128")), "svgf");
}

TEST(FilterText, WithAMisspeltNameIsAnsweredWithTheNearest) {
  EXPECT_THAT(complaint("svfg"), testing::HasSubstr("did you mean 'svgf'?; accepted: " + names()));
  EXPECT_THAT(complaint("svgf:sigma_L=2"), testing::HasSubstr("did you mean 'sigma_l'?"));
  EXPECT_THAT(complaint("svgf:sigma_L=2"),
              testing::HasSubstr("accepted: levels, sigma_z, sigma_n, sigma_l, variance"));
  EXPECT_THAT(complaint("something else"), testing::Not(testing::HasSubstr("did you mean")));
  // Of what was typed 64 letters, whatever the length of the list of filters.
  EXPECT_THAT(complaint(std::string(1 << 20, 'x')), testing::SizeIs(testing::Lt(names().size() + 100)));
}

TEST(FilterText, WithAValueOutOfRangeIsAnsweredWithTheRange) {
  for (const std::string value : {"0", "6", "2.5", "-1", "nan", "inf", "1e999", "", "two", "2x", " 2"})
    EXPECT_THAT(complaint("atrous:levels=" + value),
                testing::HasSubstr("accepted: whole numbers from 1 to 5"))
        << value;
  EXPECT_THAT(complaint("svgf:variance=temporal"), testing::HasSubstr("accepted: spatial, samples"));
  EXPECT_THAT(complaint("svgf:variance=1"), testing::HasSubstr("accepted: spatial, samples"));
  EXPECT_THAT(complaint("svgf:sigma_n=100"), testing::HasSubstr("64, 128, 256"));
}

TEST(FilterText, ThatIsNoListOfParametersIsRefused) {
  EXPECT_THAT(complaint("svgf:levels"), testing::HasSubstr("levels needs a value"));
  EXPECT_THAT(complaint("svgf:levels=2,levels=3"), testing::HasSubstr("given twice"));
  EXPECT_THAT(complaint("none:levels=2"), testing::HasSubstr("no parameters"));
  for (const std::string_view text :
       {"", ":", "svgf:", "svgf:,", "svgf:levels=2,,sigma_l=1", "svgf:=2", " svgf"})
    complaint(text);
}

TEST(FilterPlan, FromOutsideIsCheckedInEveryParameter) {
  FilterPlan plan = parse_filter("svgf");
  plan.parameters["sigma_l"] = std::nan("");
  EXPECT_THAT(complaint(plan), testing::HasSubstr("sigma_l"));
  plan = parse_filter("svgf");
  plan.parameters["variance"] = 2;
  EXPECT_THAT(complaint(plan), testing::HasSubstr("accepted: spatial, samples"));
  plan = parse_filter("svgf");
  plan.parameters.erase("levels");
  EXPECT_THAT(complaint(plan), testing::HasSubstr("levels is missing"));
  plan = parse_filter("svgf");
  plan.parameters["gamma"] = 1;
  EXPECT_THAT(complaint(plan), testing::HasSubstr("no parameter 'gamma'"));
  EXPECT_THAT(complaint(FilterPlan{"blur", {}}), testing::HasSubstr("accepted: " + names()));
}

TEST(FilterHalo, IsWhatThePassesReachTogether) {
  EXPECT_EQ(parse_filter("none").halo(), 0);
  for (int levels = 1; levels <= 5; ++levels) {
    const std::string parameter = ":levels=" + std::to_string(levels);
    const int reach = 2 * ((1 << levels) - 1);  // 2 + 4 + ... + 2^levels
    EXPECT_EQ(parse_filter("atrous" + parameter).halo(), reach);
    EXPECT_EQ(parse_filter("sure-atrous:mode=literal,levels=" + std::to_string(levels)).halo(), reach);
    EXPECT_EQ(parse_filter("sure-atrous:window=1,levels=" + std::to_string(levels)).halo(),
              reach + (1 << (levels - 1)));
    EXPECT_EQ(parse_filter("svgf" + parameter).halo(), reach + 3);
    EXPECT_EQ(parse_filter("svgf" + parameter + ",variance=spatial").halo(), reach + 3);
  }
  EXPECT_EQ(parse_filter("atrous").halo(), 62);
  EXPECT_EQ(parse_filter("sure-atrous").halo(), 94);
  EXPECT_EQ(parse_filter("sure-atrous:variance=spatial").halo(), 97);
  EXPECT_EQ(parse_filter("svgf").halo(), 65);
}

TEST(FilterDescriptions, SayWhatTheyTakeAndWhereEveryNumberComesFrom) {
  for (const FilterDescription& d : filters()) {
    const std::vector<Channel> inputs = parse_filter(d.name).inputs();
    EXPECT_FALSE(d.summary.empty() || inputs.empty());
    for (const Channel& c : inputs) EXPECT_LT(c.index, info(c.aov).channels);
    for (const Parameter& p : d.parameters) {
      EXPECT_FALSE(p.meaning.empty() || p.source.empty()) << p.name;
      EXPECT_LE(p.low, p.standard) << p.name;
      EXPECT_GE(p.high, p.standard) << p.name;
      if (p.choices.empty()) continue;
      EXPECT_EQ(p.high - p.low + 1, static_cast<double>(p.choices.size())) << p.name;
    }
  }
}

TEST(Nearest, CountsSlipsAndGivesUpWhereNothingIsNear) {
  const std::string_view names[] = {"none", "atrous", "svgf"};
  EXPECT_EQ(nearest("atrus", names), "atrous");
  EXPECT_EQ(nearest("artous", names), "atrous");
  EXPECT_EQ(nearest("svg", names), "svgf");
  EXPECT_EQ(nearest("nonee", names), "none");
  EXPECT_EQ(nearest("", names), "");
  EXPECT_EQ(nearest("bilateral", names), "");
  EXPECT_EQ(nearest("x", {}), "");
}

}  // namespace
}  // namespace tessera
