// The version of the server, "major.minor.patch".
#pragma once

namespace arap::app {

const char* Version();

}  // namespace arap::app
