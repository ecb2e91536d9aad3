// SPDX-License-Identifier: Apache-2.0
// The descriptions that make up filters(): one function, one file, one filter each.
#pragma once

#include <initializer_list>

#include "core/filter/filter.h"

namespace tessera {

FilterDescription describe_none();
FilterDescription describe_atrous();
FilterDescription describe_bmfr();
FilterDescription describe_statmc();
FilterDescription describe_sure_atrous();
FilterDescription describe_nlm();
FilterDescription describe_svgf();

// Levels 0 .. levels-1 of the a-trous wavelet transform (Dammertz et al. 2010, section 2): the 5x5 B3 kernel
// with 2^i - 1 holes between its taps, so that level i reads 2 * 2^i pixels far. Appended to `passes`;
// `first` says kernel and cost.
void append_levels(std::vector<Pass>& passes, const Pass& first, int levels);

// All channels of each AOV.
void append(std::vector<Channel>& to, std::initializer_list<Aov>, Statistic = Statistic::mean,
            Share = Share::all);

// Operations of exp2_of_negative in the kernels (worker/denoise/kernels/common.cl).
inline constexpr double kExpFlops = 15;

// Parameters that several a-trous filters have.
Parameter levels_parameter(std::string_view source);
Parameter sigma_n_parameter(std::string_view source);
Parameter sigma_x_parameter(std::string_view source);

}  // namespace tessera
