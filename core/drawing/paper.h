// Sizes of paper.
#pragma once

#include <string_view>

#include "arap/base/result.h"

namespace arap {

struct Paper {
  double width = 0, height = 0;  // millimetres
  bool either_way = false;       // may be turned on its side
};

// "A4" (A0 to A5), "letter", "legal", "tabloid", or "WIDTHxHEIGHT" in millimetres, which is not
// turned. kInvalidOption for anything else and for sides that are not 100 to 5080 mm.
Result<Paper> ParsePaper(std::string_view text);

}  // namespace arap
