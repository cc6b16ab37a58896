// A run as one page that can be sent around: it loads nothing and runs nothing.
#pragma once

#include <span>
#include <string>

#include "client/cli/load/results.h"
#include "client/cli/load/threshold.h"

namespace arap::cli {

// Latency and rates over time, percentiles, rate against latency, errors and settings, as pictures and
// as tables of the same figures; light or dark as the reader has it, from 390 pixels of width on. At most
// about 200 kB for each operation. The same results make the same bytes.
std::string LoadHtml(const LoadResults& results, std::span<const Judgement> judgements);

}  // namespace arap::cli
