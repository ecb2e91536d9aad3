// SPDX-License-Identifier: Apache-2.0
// What each filter is: inputs, parameters, passes. The halo is derived from the passes, never typed in.
// The arithmetic lives in worker/denoise/kernels; the scalar references in tests/reference.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/aov.h"

namespace tessera {

// One kernel run over the region that later passes still need (or several of one name, counted as one).
struct Pass {
  std::string_view kernel;
  int step = 1;
  int radius = 0;                // how far it reads, in pixels
  double flops = 0, floats = 0;  // of a pixel: operations (a fused multiply-add is two); floats that must be
                                 // read and written, each plane once
};

// The reach of the passes run one after another: the sum of the radii.
int halo(std::span<const Pass> passes);

// What only the whole scene knows. 0: not known.
struct SceneFacts {
  double diameter = 0;  // of everything in it, world units
  double light = 0;     // mean luminance of what emits
  int frame = 0;        // number of the frame
  bool operator==(const SceneFacts&) const = default;
};
enum class SceneFact : std::uint8_t { none, diameter, light, frame };

// A number with its unit and source, or a choice among names.
struct Parameter {
  std::string_view name, meaning, unit, source;
  double low = 0, high = 0, standard = 0;  // inclusive range and default; whole numbers where `integral`
  bool integral = false;
  std::vector<std::string_view> choices = {};  // not empty: the value is an index into these
  SceneFact fact = SceneFact::none;            // which takes the place of a 0: see resolved()
};

using ParameterValues = std::map<std::string, double, std::less<>>;

struct FilterDescription {
  std::string_view name, summary, source;
  std::vector<Parameter> parameters;
  // In the order in which the kernels take them.
  std::vector<Channel> (*inputs)(const ParameterValues&);
  std::vector<Pass> (*passes)(const ParameterValues&);
  // Floats of working memory a pixel of the outer region takes, beside inputs and output.
  double (*scratch)(const ParameterValues&);
  // Planes it keeps of each frame for the next one (see history.h), where it then finds them by Aov::motion,
  // which must be among its inputs. Null: none, whatever the parameters.
  int (*history)(const ParameterValues&) = nullptr;
  // Changes what is left to the filter to what it is for a frame that has no history. Null: nothing is.
  void (*alone)(ParameterValues&) = nullptr;
};

// All filters, by name. `none` is one: it has no passes.
std::span<const FilterDescription> filters();

// A filter with every parameter decided: what a job carries.
struct FilterPlan {
  std::string name = "none";
  ParameterValues parameters;  // all of them, defaults filled in

  const FilterDescription& description() const;
  std::vector<Channel> inputs() const;
  std::vector<Pass> passes() const;
  int halo() const;
  int history() const;  // planes; 0: it looks at one frame alone
  double operator[](std::string_view parameter) const { return parameters.find(parameter)->second; }
  // Which of the parameter's choices is taken.
  bool is(std::string_view parameter, std::string_view choice) const;
  bool operator==(const FilterPlan&) const = default;
};

// Reads "svgf" or "svgf:levels=4,sigma_l=2,variance=spatial". Throws Error(bad_usage) that names the nearest
// filter or parameter, and the accepted range or choices.
FilterPlan parse_filter(std::string_view text);
// The inverse: the name with every parameter that is not at its default.
std::string to_string(const FilterPlan&);
// With the scene's facts in place of zeros; a fact that is not known counts as 1, the frame's number modulo
// the numbers that the parameter can be. Once per frame, before it is cut into tiles.
FilterPlan resolved(FilterPlan, const SceneFacts&);
// As it is for the first frame of a shot, or one behind a cut. It keeps as much for the next one.
FilterPlan without_history(FilterPlan);
// Throws Error(bad_input) unless every parameter is known, present and in range: for plans that come by
// message.
void validate(const FilterPlan&);

}  // namespace tessera
