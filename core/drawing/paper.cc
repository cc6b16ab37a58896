#include "core/drawing/paper.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>

#include <fmt/format.h>

#include "core/base/names.h"
#include "core/drawing/pdf.h"

namespace arap {

Result<Paper> ParsePaper(std::string_view text) {
  struct Named {
    std::string_view name;
    double width, height;
  };
  constexpr std::array<Named, 9> kNamed{{{"A0", 841, 1189},
                                         {"A1", 594, 841},
                                         {"A2", 420, 594},
                                         {"A3", 297, 420},
                                         {"A4", 210, 297},
                                         {"A5", 148, 210},
                                         {"letter", 215.9, 279.4},
                                         {"legal", 215.9, 355.6},
                                         {"tabloid", 279.4, 431.8}}};
  for (const Named& named : kNamed) {
    if (text == named.name) return Paper{named.width, named.height, true};
  }
  constexpr double kSmallest = 100;  // a square of 50 mm and what is said about it
  std::array<double, 2> sides{};
  const std::size_t cross = std::min(text.find('x'), text.size());
  const auto read = [](std::string_view number, double& side) {
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), side);
    return error == std::errc() && end == number.data() + number.size() && side >= kSmallest &&
           side <= kLargestPdfPage;
  };
  if (cross < text.size() && read(text.substr(0, cross), sides[0]) &&
      read(text.substr(cross + 1), sides[1])) {
    return Paper{sides[0], sides[1], false};
  }
  return Fail(Fault(FaultKind::kInvalidOption,
                    fmt::format("The paper {} is none of A0 to A5, letter, legal, tabloid, or "
                                "WIDTHxHEIGHT with {:.0f} to {:.0f} mm.",
                                Quote(text), kSmallest, kLargestPdfPage))
                  .Field("paper"));
}

}  // namespace arap
