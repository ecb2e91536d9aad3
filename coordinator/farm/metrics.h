// SPDX-License-Identifier: Apache-2.0
// A farm's figures as Prometheus reads them (text format 0.0.4).
#pragma once

#include <string>

#include "coordinator/farm/figures.h"

namespace tessera {

// The content type that goes with it.
inline constexpr const char* kMetricsType = "text/plain; version=0.0.4; charset=utf-8";

// Labels are bounded: states, reasons, and at most kMostJobs jobs that are active.
std::string metrics_text(const FarmFigures&);

}  // namespace tessera
