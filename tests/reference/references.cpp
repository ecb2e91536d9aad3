// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/references.h"

#include <map>
#include <string_view>

#include "core/filter/taa.h"
#include "tests/reference/atrous.h"
#include "tests/reference/bilateral.h"
#include "tests/reference/bmfr.h"
#include "tests/reference/ddf.h"
#include "tests/reference/fdf.h"
#include "tests/reference/guided.h"
#include "tests/reference/nfor.h"
#include "tests/reference/nlm.h"
#include "tests/reference/rdfc.h"
#include "tests/reference/rhf.h"
#include "tests/reference/rpf.h"
#include "tests/reference/sbf.h"
#include "tests/reference/separable.h"
#include "tests/reference/statmc.h"
#include "tests/reference/sure_atrous.h"
#include "tests/reference/svgf.h"
#include "tests/reference/taa.h"

namespace tessera::reference {

Image filtered(const FilterPlan& asked, const Image& input, const Image& history) {
  const FilterPlan plan = history.empty() ? without_history(asked) : asked;
  static const std::map<std::string_view, Image (*)(const FilterPlan&, const Image&, const Image&)> temporal{
      {"atrous", atrous},
      {"bmfr", bmfr},
      {"svgf", svgf},
  };
  static const std::map<std::string_view, Image (*)(const FilterPlan&, const Image&)> all{
      {"bilateral", bilateral},
      {"box", box},
      {"cross-bilateral", cross_bilateral},
      {"fdf", fdf},
      {"ddf", ddf},
      {"gaussian", gaussian},
      {"guided", guided},
      {"nfor", nfor},
      {"nlm", nlm},
      {"rhf", rhf},
      {"rpf", rpf},
      {"rdfc", rdfc},
      {"sbf", sbf},
      {"statmc", statmc},
      {"sure-atrous", sure_atrous},
  };
  if (const auto t = temporal.find(plan.name); t != temporal.end()) {
    Image result = t->second(plan, input, history);
    if (plan.parameters.contains("taa") && with_taa(plan.parameters)) taa(plan, input, history, result);
    return result;
  }
  return all.at(plan.name)(plan, input);
}

}  // namespace tessera::reference
