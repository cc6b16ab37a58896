#include "client/cli/load/results.h"

namespace arap::cli {

void OperationResults::Add(const OperationResults& more) {
  response.Merge(more.response);
  service.Merge(more.service);
  queue.Merge(more.queue);
  solve.Merge(more.solve);
  sent += more.sent;
  answered += more.answered;
  failed += more.failed;
  late += more.late;
  unsent += more.unsent;
  replaced += more.replaced;
  verified += more.verified;
  wrong += more.wrong;
}

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
  for (const OperationResults& done : operations) total.Add(done);
  return total;
}

double LoadResults::PerSecond(std::uint64_t count) const {
  return seconds > 0 ? static_cast<double>(count) / seconds : 0;
}

}  // namespace arap::cli
