// Records for tests of the store.
#pragma once

#include <cstddef>
#include <string>

#include "server/store/store.h"
#include "tests/support/random.h"

namespace arap::testing {

// Wall time now, in whole milliseconds.
runtime::Clock::Wall Now();

// Small and plain; expires in an hour. Its mesh "face" names the blob of 64 digits `digit`.
store::SessionRecord PlainRecord(const std::string& owner, const std::string& id, char digit = 'a');
// Every field at random: all bit patterns of doubles, names of any UTF-8.
store::SessionRecord RandomRecord(Random& random);
// As it was, one revision later.
store::SessionRecord Next(store::SessionRecord record);

// Empty when they agree in every bit, else the first field that does not.
std::string Difference(const store::SessionRecord& a, const store::SessionRecord& b);

}  // namespace arap::testing
