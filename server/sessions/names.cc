#include "server/sessions/names.h"

#include <fmt/format.h>

namespace arap::app {}  // namespace arap::app
