#include "server/version.h"

namespace arap::app {

const char* Version() { return ARAP_VERSION; }

}  // namespace arap::app
