// Definitions: handle sets as clients describe them, compared and edited without compiling.
#pragma once

#include <string>
#include <vector>

#include "arap/model/handle.h"

namespace arap::app {

// Whether two lists describe the same handles in the same order, bit for bit.
bool SameDefinitions(const std::vector<Handle>& a, const std::vector<Handle>& b);

// The definitions after CompiledHandles::Edit with the same arguments.
std::vector<Handle> EditDefinitions(const std::vector<Handle>& definitions,
                                    const std::vector<std::string>& remove,
                                    const std::vector<Handle>& add);

}  // namespace arap::app
