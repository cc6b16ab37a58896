#include "client/cli/load/results.h"

namespace arap::cli {

std::vector<Operation> LoadResults::Done() const {
  std::vector<Operation> done;
  for (std::size_t k = 0; k < kOperations; ++k) {
    const auto operation = static_cast<Operation>(k);
    if (operations[operation].Any()) done.push_back(operation);
  }
  return done;
}

OperationResults LoadResults::Total() const {
  OperationResults total;
  for (const OperationResults& done : operations) {
    total.response.Merge(done.response);
    total.service.Merge(done.service);
    total.queue.Merge(done.queue);
    total.solve.Merge(done.solve);
    total.sent += done.sent;
    total.answered += done.answered;
    total.failed += done.failed;
    total.late += done.late;
    total.unsent += done.unsent;
    total.replaced += done.replaced;
    total.verified += done.verified;
    total.wrong += done.wrong;
  }
  return total;
}

double LoadResults::PerSecond(std::uint64_t count) const {
  return seconds > 0 ? static_cast<double>(count) / seconds : 0;
}

}  // namespace arap::cli
