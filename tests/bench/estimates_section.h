// What work is estimated to take (arap/core/cost.h, EstimateFlatten) beside what it takes, over a
// grid of sizes and of kinds of work: the tables of docs/operations.md.
#pragma once

#include <nlohmann/json.hpp>

namespace arap::bench {

// {"<row>": {"<column>": cell}}, cells as in estimated_cell.h; prints each row when it is measured.
// `million`: of the largest that a server takes alone, registered and laid flat once.
nlohmann::ordered_json MeasureDeformEstimates(bool million);
nlohmann::ordered_json MeasureFlattenEstimates(bool million);

// Both as {"deform / <row>": …, "flatten / <row>": …}, and in the end the worst cells. Its figures
// stand one level deeper than those of other sections, so that CompareRuns leaves them alone: they are
// of few runs, and what they judge is the estimates.
nlohmann::ordered_json MeasureEstimates(bool million);

}  // namespace arap::bench
