// SPDX-License-Identifier: Apache-2.0
// The descriptions that make up filters(): one function, one file, one filter each.
#pragma once

#include <initializer_list>

#include "core/filter/filter.h"

namespace tessera {

FilterDescription describe_none();
FilterDescription describe_atrous();
FilterDescription describe_bilateral();
FilterDescription describe_box();
FilterDescription describe_cross_bilateral();
FilterDescription describe_ddf();
FilterDescription describe_gaussian();
FilterDescription describe_statmc();
FilterDescription describe_bmfr();
FilterDescription describe_rhf();
FilterDescription describe_rdfc();
FilterDescription describe_sbf();
FilterDescription describe_guided();
FilterDescription describe_rpf();
FilterDescription describe_sure_atrous();
FilterDescription describe_fdf();
FilterDescription describe_nfor();
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
// And of number_of, with the bound that keeps its exponent from falling below 0.
inline constexpr double kNumberFlops = 10;
// And of weight_of (worker/denoise/kernels/window.cl).
inline constexpr double kWeightFlops = 12;
// And of the one of the a-trous levels (worker/denoise/kernels/geometry.cl): bound, whole number, bits,
// polynomial, bits.
inline constexpr double kLevelWeightFlops = 1 + 1 + 2 + 8 + 2;

// One of the names, by default that of number `standard`.
Parameter choice_parameter(std::string_view name, std::string_view meaning, std::string_view source,
                           std::vector<std::string_view> choices, double standard = 0);

// Parameters that several a-trous filters have.
Parameter levels_parameter(std::string_view source);
Parameter sigma_n_parameter(std::string_view source);
Parameter sigma_x_parameter(std::string_view source);

// The width of a window with the pixel in its centre: an odd number. Its radius, by the parameter's name.
Parameter window_parameter(std::string_view name, int standard, std::string_view source);
int window_radius(const ParameterValues&, std::string_view name);
// Floats a pixel takes for `planes` in strips with room for a window (worker/denoise/window.h).
double window_scratch(int planes);

// The parameter `history`: whether a filter goes by the frame before. What it then keeps, see history.h.
Parameter history_parameter();
bool with_history(const ParameterValues&);
// And what weighs in an accumulation over frames: `alpha`, `average`.
Parameter alpha_parameter(std::string_view name, std::string_view meaning);
Parameter average_parameter();
// What tells where a surface was one frame before, and that it is the same one: appended, if there is a
// history.
void append_trace(std::vector<Channel>& to, const ParameterValues&);
// Planes that a history has beside what it accumulates: its length, and what the next frame's test compares
// (worker/denoise/kernels/history.cl).
inline constexpr int kTracePlanes = 1 + 5;
// The pass that accumulates `planes` over frames. `own`: floats that it reads and writes of the filter's
// planes.
Pass accumulation(std::string_view kernel, int planes, double own);

// The parameter `diameter` of filters that measure depth in tenths of the scene's diameter.
Parameter diameter_parameter();

}  // namespace tessera
